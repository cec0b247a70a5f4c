// The mesh of GeodesicGraph/DGG_and_SVG from that of a session, for its ICH and its DGG. Included
// after its sources.

#pragma once

// What reads files is not compiled.
CBaseModel::CBaseModel(const std::string& filename) : m_filename(filename), m_fBeLoaded(true) {}
void CBaseModel::LoadModel() {}

struct Surface : CRichModel {
    explicit Surface(const peer::Model& model) : CBaseModel(""), CRichModel("") {
        const double* at = model.points.data();
        for (std::size_t vertex = 0; vertex < model.vertices(); ++vertex, at += 3)
            m_Verts.emplace_back(at[0], at[1], at[2]);
        for (std::size_t face = 0; face < model.faces.size(); face += 3)
            m_Faces.emplace_back(model.faces[face], model.faces[face + 1], model.faces[face + 2]);
        Preprocess();
    }
};
