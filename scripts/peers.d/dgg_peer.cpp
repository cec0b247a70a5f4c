// The discrete geodesic graph (FastDGG) of GeodesicGraph/DGG_and_SVG, with the accuracy 0.01 of its
// README. Setting it up is its precomputation, one local search from each vertex; a solve is
// Dijkstra's algorithm on the graph in single precision, as in its `DGG_Solution`. Its own programs
// exchange the graph in files. `mend_dgg` of scripts/peers says what is changed.

#include "session.hpp"

#include <cfloat>
#include <cstdlib>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <queue>
#include <set>
#include <utility>

inline unsigned GetTickCount() { return 0; }

#include "stdafx.h"

#include "ICH/ExactMethodForDGP.cpp"
#include "ICH/Point3D.cpp"
#include "ICH/PreviousCH.cpp"
#include "ICH/RichModel.cpp"

#include "DGG_precompute/FastDGG.cpp"

#include "rich_model.hpp"

struct Solver {
    static constexpr double accuracy = 0.01;

    Surface surface;
    std::vector<std::vector<std::pair<unsigned, float>>> edges;
    std::vector<float> distances;

    explicit Solver(const peer::Model& model) : surface(model), edges(model.vertices()) {
        for (unsigned source = 0; source < edges.size(); ++source) {
            CFastDGG search(surface, std::vector<int>{static_cast<int>(source)});
            std::set<int> reached;
            search.ExecuteLocally_FastDGG(accuracy, reached);
            for (const int vertex : reached) {
                const auto& info = search.m_InfoAtVertices.find(vertex)->second;
                const int parent =
                    info.fParentIsPseudoSource ? info.indexOfParent : info.indexOfRootVertOfParent;
                if (parent == static_cast<int>(source))
                    edges[source].emplace_back(vertex, static_cast<float>(info.disUptodate));
            }
        }
    }

    void solve(unsigned source) {
        using Entry = std::pair<float, unsigned>;
        distances.assign(edges.size(), std::numeric_limits<float>::infinity());
        std::priority_queue<Entry, std::vector<Entry>, std::greater<Entry>> queue;
        distances[source] = 0;
        queue.emplace(0.0f, source);
        while (!queue.empty()) {
            const auto [distance, vertex] = queue.top();
            queue.pop();
            if (distance > distances[vertex]) continue;
            for (const auto& [next, length] : edges[vertex]) {
                if (distance + length < distances[next]) {
                    distances[next] = distance + length;
                    queue.emplace(distances[next], next);
                }
            }
        }
    }

    double distance(std::size_t vertex) { return distances[vertex]; }
};

int main() { return peer::serve<Solver>(); }
