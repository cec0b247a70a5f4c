// ICH by an author of its paper (Xin), as GeodesicGraph/DGG_and_SVG has it: the filter of Xin and
// Wang and a priority queue of windows. `mend_ich` of scripts/peers says what is changed.

#include "session.hpp"

#include <cfloat>
#include <memory>
#include <cstdlib>
#include <memory>
#include <set>

// The program draws its models, too; nothing is drawn here.
using GLenum = unsigned;
using GLfloat = float;
inline void glColor3f(GLfloat, GLfloat, GLfloat) {}
inline void glNormal3f(GLfloat, GLfloat, GLfloat) {}
inline void glVertex3f(GLfloat, GLfloat, GLfloat) {}

inline unsigned GetTickCount() { return 0; }

// Values by vertex or by edge, in an array, where the source has a tree.
template <typename Value>
class Values {
public:
    struct Entry {
        Value second;
    };
    using const_iterator = const Entry*;

    void resize(std::size_t count) { entries.resize(count); }
    Value& operator[](int index) { return entries[index].second; }
    const_iterator find(int index) const { return &entries[index]; }
    const_iterator end() const { return entries.data() + entries.size(); }

private:
    std::vector<Entry> entries;
};

#include "stdafx.h"

#include "ICH/ExactMethodForDGP.cpp"
#include "ICH/ICHWithFurtherPriorityQueue.cpp"
#include "ICH/ImprovedCHWithEdgeValve.cpp"
#include "ICH/Point3D.cpp"
#include "ICH/PreviousCH.cpp"
#include "ICH/RichModel.cpp"

// What draws is not compiled.
void CBaseModel::Render(GLenum) const {}
void CBaseModel::Render(GLenum, const std::vector<float>*) const {}

#include "rich_model.hpp"

struct Solver {
    Surface surface;
    std::unique_ptr<CICHWithFurtherPriorityQueue> algorithm;

    explicit Solver(const peer::Model& model) : surface(model) {}

    void solve(unsigned source) {
        const std::vector<int> sources{static_cast<int>(source)};
        algorithm.reset(new CICHWithFurtherPriorityQueue(surface, sources));
        algorithm->Execute();
    }

    double distance(std::size_t vertex) { return algorithm->m_InfoAtVertices[vertex].disUptodate; }
};

int main() { return peer::serve<Solver>(); }
