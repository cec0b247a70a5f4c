// The protocol of docs/protocol.md for adapters in C++: `peer::serve` loads the model, and
// for each request makes a solver, times its solve alone and writes the distances.

#pragma once

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
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

// Lets the system forget the peak of memory until now; false where it cannot.
inline bool reset_peak() {
    std::ofstream file("/proc/self/clear_refs");
    file << "5" << std::flush;
    return file.good();
}

inline std::string peak() {
    std::ifstream file("/proc/self/status");
    std::string line;
    while (std::getline(file, line))
        if (line.rfind("VmHWM:", 0) == 0) return std::to_string(1024 * std::stoll(line.substr(6)));
    return "null";
}

// Libraries print what they like; only answers may go where geobench reads.
class Quiet {
public:
    Quiet() : output(std::cout.rdbuf(std::cerr.rdbuf())) {}
    ~Quiet() { std::cout.rdbuf(output); }

private:
    std::streambuf* output;
};

// Answers requests until the end of input. `Solver(model, source)` is made anew for each, outside of
// the measured time, since programs keep their tree or their windows after a solve; `solve()` is
// measured, and then `distance(vertex)` answers, with infinity or a negative number for a vertex that
// is not reached.
template <typename Solver>
int serve(int argc, char** argv) {
    if (argc != 4) {
        std::cerr << "usage: " << argv[0] << " MODEL SOURCE OUTPUT\n";
        return 2;
    }
    const Model model = load(argv[1]);
    const auto source = static_cast<unsigned>(std::strtoul(argv[2], nullptr, 10));
    std::printf("{\"ready\": true}\n");
    std::fflush(stdout);
    std::string request;
    while (std::getline(std::cin, request)) {
        using Clock = std::chrono::steady_clock;
        const Quiet quiet;
        const auto begin = Clock::now();
        Solver solver(model, source);
        const std::chrono::duration<double> setup = Clock::now() - begin;
        const bool known = reset_peak();
        const auto start = Clock::now();
        solver.solve();
        const std::chrono::duration<double> seconds = Clock::now() - start;
        const std::string bytes = known ? peak() : "null";
        std::FILE* output = std::fopen(argv[3], "w");
        if (output == nullptr) return 1;
        std::fputs("vertex,distance\n", output);
        for (std::size_t vertex = 0; vertex < model.vertices(); ++vertex) {
            const double distance = solver.distance(vertex);
            if (distance < 0 || std::isinf(distance) || distance >= 1e30)
                std::fprintf(output, "%zu,inf\n", vertex);
            else
                std::fprintf(output, "%zu,%.17g\n", vertex, distance);
        }
        std::fclose(output);
        std::printf("{\"seconds\": %.9f, \"setup_seconds\": %.9f, \"rss_peak_bytes\": %s}\n",
                    seconds.count(), setup.count(), bytes.c_str());
        std::fflush(stdout);
    }
    return 0;
}

} // namespace peer
