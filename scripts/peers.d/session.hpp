// Protocol 2 of docs/protocol.md for adapters in C++: `peer::serve` answers requests with a
// solver, and times its solve alone.

#pragma once

#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

namespace peer {

// A triangle mesh: three coordinates for each vertex, three vertices for each face.
struct Model {
    std::vector<double> points;
    std::vector<unsigned> faces;

    std::size_t vertices() const { return points.size() / 3; }
};

// Reads `v x y z` and `f a b c`, as geobench writes them.
inline Model load(const char* path) {
    Model model;
    std::ifstream file(path);
    std::string line;
    while (std::getline(file, line)) {
        std::istringstream words(line);
        std::string kind;
        words >> kind;
        if (kind == "v") {
            double x, y, z;
            words >> x >> y >> z;
            model.points.insert(model.points.end(), {x, y, z});
        } else if (kind == "f") {
            unsigned a, b, c;
            words >> a >> b >> c;
            model.faces.insert(model.faces.end(), {a - 1, b - 1, c - 1});
        }
    }
    return model;
}

// Libraries print what they like; only answers may go where geobench reads.
class Quiet {
public:
    Quiet() : output(std::cout.rdbuf(std::cerr.rdbuf())) {}
    ~Quiet() { std::cout.rdbuf(output); }

private:
    std::streambuf* output;
};

// Answers requests until the end of input. `Solver(model)` is made when the model is loaded and
// anew after each run, since programs keep their tree or their windows after a solve;
// `solve(source)` is measured, and then `distance(vertex)` answers, with infinity or a negative
// number for a vertex that is not reached.
template <typename Solver>
int serve() {
    using Clock = std::chrono::steady_clock;
    Model model;
    std::unique_ptr<Solver> solver;
    const auto timed = [](auto work) {
        const Quiet quiet;
        const auto start = Clock::now();
        work();
        return std::chrono::duration<double>(Clock::now() - start).count();
    };
    const auto prepare = [&] {
        solver.reset();
        std::printf("{\"setup_seconds\": %.9f}\n", timed([&] { solver = std::make_unique<Solver>(model); }));
    };
    std::string request;
    while (std::getline(std::cin, request)) {
        const auto space = request.find(' ');
        const std::string word = request.substr(0, space);
        const std::string rest = space == std::string::npos ? "" : request.substr(space + 1);
        if (word == "load") {
            model = load(rest.c_str());
            prepare();
        } else if (word == "ping") {
            std::printf("{}\n");
        } else if (word == "solve") {
            const auto source = static_cast<unsigned>(std::stoul(rest));
            std::printf("{\"seconds\": %.9f}\n", timed([&] { solver->solve(source); }));
        } else if (word == "write") {
            std::FILE* output = std::fopen(rest.c_str(), "w");
            if (output == nullptr) return 1;
            std::fputs("vertex,distance\n", output);
            for (std::size_t vertex = 0; vertex < model.vertices(); ++vertex) {
                const double distance = solver->distance(vertex);
                if (distance < 0 || std::isinf(distance) || distance >= 1e30)
                    std::fprintf(output, "%zu,inf\n", vertex);
                else
                    std::fprintf(output, "%zu,%.17g\n", vertex, distance);
            }
            std::fclose(output);
            prepare();
        } else {
            std::cerr << "unknown request: " << request << "\n";
            return 2;
        }
        std::fflush(stdout);
    }
    return 0;
}

} // namespace peer
