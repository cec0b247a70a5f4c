# One command remakes a table of a paper; see scripts/replicate.
#
#   docker build -t geobench . && docker run --rm geobench
#   docker run --rm -v "$PWD:/work" -w /work geobench geobench run model.obj
FROM rust:1.95-bookworm AS build
WORKDIR /source
COPY . .
RUN cargo build --release --locked --bin geobench

FROM debian:bookworm-slim
COPY --from=build /source/target/release/geobench /usr/local/bin/
COPY --from=build /source/scripts/replicate /usr/local/bin/replicate
ENV GEOBENCH=/usr/local/bin/geobench
WORKDIR /work
CMD ["replicate"]
