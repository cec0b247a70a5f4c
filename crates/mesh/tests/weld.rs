//! Welding, and the note on what it would join.

mod validate_support;

use std::fmt::Write;
use std::path::Path;

use geobench_mesh::{
    Defect, DefectKind, MeshMeasures, SplitMix64, TriangleSoup, VertexId, Weld, io,
};
use validate_support::{cube, grid, mesh_of};

/// The soup with a vertex for each corner of each triangle, moved by up to `shift` along each axis.
fn unwelded(soup: &TriangleSoup, shift: f64) -> TriangleSoup {
    let mut random = SplitMix64::new(5);
    let mut moved = |x: f64| x + shift * (2.0 * random.unit() - 1.0);
    let corners = soup.triangles.as_flattened().iter();
    let positions = corners.map(|&v| soup.positions[v as usize].map(&mut moved));
    let triangles = (0..soup.triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]);
    TriangleSoup::new(positions.collect(), triangles.collect())
}

fn welded(mut soup: TriangleSoup, tolerance: f64) -> TriangleSoup {
    soup.weld(Weld::within(tolerance).unwrap());
    soup
}

fn measures(soup: TriangleSoup) -> MeshMeasures {
    MeshMeasures::of(&mesh_of(soup).0)
}

#[test]
fn triangles_that_share_no_vertex_become_one_surface() {
    for (shift, tolerance) in [(0.0, 0.0), (0.0, 1e-6), (1e-8, 1e-6)] {
        let soup = unwelded(&cube(), shift);
        let vertices = soup.positions.len();
        let found = measures(welded(soup, tolerance));
        assert_eq!((found.vertices, found.faces), (vertices, 12));
        assert_eq!((found.components, found.boundary_edges), (1, 0));
        assert_eq!(
            (found.isolated_vertices, found.euler_characteristic),
            (0, 2)
        );
    }
}

#[test]
fn copies_keep_their_number_and_place_and_get_the_values_of_the_first() {
    let soup = unwelded(&grid(1, 1), 0.0); // Corners 0, 1, 3 and 0, 3, 2 of the square.
    let positions = soup.positions.clone();
    let (mesh, report) = mesh_of(welded(soup, 0.0));
    assert_eq!(mesh.positions(), positions);
    let copies: Vec<_> = mesh.copies().collect();
    let pair = |copy: u32, kept: u32| [copy, kept].map(VertexId::new);
    assert_eq!(copies, [pair(3, 0), pair(4, 2)]);
    assert_eq!(report.defects, [Defect::WeldedVertices { count: 2 }]);
    let mut values = [5, 1, 7, 0, 0, 2];
    mesh.fill_copies(&mut values);
    assert_eq!(values, [5, 1, 7, 5, 7, 2]);
    // Points name copies, too.
    assert_eq!(mesh.with_points(&[4.into()]).unwrap().vertices, [2.into()]);
    let on_edge = |ends: [u32; 2]| mesh.point_on_edge(ends.map(VertexId::new), 0.25);
    assert_eq!(on_edge([3, 4]).unwrap(), on_edge([0, 2]).unwrap());
    // A mesh written and built again is welded alike.
    let (again, _) = mesh_of(mesh.to_soup());
    assert_eq!(again.copies().collect::<Vec<_>>(), copies);
}

#[test]
fn a_copy_is_no_place_of_the_surface() {
    // A square whose second triangle is 1e-3 above the first.
    let mut soup = unwelded(&grid(1, 1), 0.0);
    soup.positions[3..].iter_mut().for_each(|p| p[2] = 1e-3);
    let (mesh, _) = mesh_of(welded(soup, 1e-2));
    assert_eq!(mesh.copies().len(), 2);
    let (point, distance) = mesh.nearest_point([-1.0, -1.0, 1e-3]).unwrap();
    assert_eq!(point.vertex(), Some(0.into()));
    assert!(distance > 2f64.sqrt());
    let copy = mesh.point_at_vertex(3.into()).unwrap();
    assert_eq!(mesh.position_of(&copy), Some([0.0; 3]));
    assert_eq!(mesh.face_of(&copy), mesh.face_of(&point));
}

#[test]
fn a_copy_gathers_nothing() {
    // 1 is a copy of 0. Welding again by less leaves 2, which is beside 1, alone.
    let positions = vec![
        [0.0; 3],
        [0.0, 0.3, 0.0],
        [0.0, 0.35, 0.0],
        [10.0, 0.0, 0.0],
        [10.0, 3.0, 0.0],
    ];
    let soup = TriangleSoup::new(positions, vec![[0, 3, 4], [1, 4, 2]]);
    let both = welded(welded(soup, 0.03), 0.01);
    assert_eq!(both.copies, [[1, 0]]);
    assert_eq!(both.triangles, [[0, 3, 4], [0, 4, 2]]);
}

#[test]
fn a_vertex_gathers_a_ball_and_no_chain() {
    // A fan whose lower vertices are 1 apart.
    let lower = (0..21).map(|x| [f64::from(x), 0.0, 0.0]);
    let positions = lower.chain([[10.5, 4.0, 0.0]]).collect();
    let mut soup = TriangleSoup::new(positions, (0..20).map(|x| [x, x + 1, 21]).collect());
    soup.weld(Weld::within(1.1 / 20f64.hypot(4.0)).unwrap());
    let pairs: Vec<[u32; 2]> = (0..10).map(|x| [2 * x + 1, 2 * x]).collect();
    assert_eq!(soup.copies, pairs);
}

#[test]
fn a_second_weld_goes_on_from_the_first() {
    let exact = welded(unwelded(&cube(), 0.0), 0.0);
    let both = welded(exact.clone(), 1e-6);
    assert_eq!(both.copies, exact.copies);
    assert_eq!(both.triangles, exact.triangles);
    let near = welded(welded(unwelded(&cube(), 1e-9), 0.0), 1e-6);
    assert_eq!(near.copies.len(), 36 - 8);
    assert!(near.copies.iter().all(|[copy, kept]| kept < copy));
}

#[test]
fn a_tolerance_is_a_fraction() {
    for wrong in ["-1e-9", "0.2", "NaN", "inf", "", "a lot"] {
        assert!(wrong.parse::<Weld>().is_err(), "{wrong}");
    }
    assert_eq!("0".parse(), Ok(Weld::COINCIDENT));
    assert_eq!(Weld::within(1e-6).unwrap().to_string(), "1e-6");
}

#[test]
fn coincident_vertices_are_noted() {
    let (_, report) = mesh_of(unwelded(&cube(), 0.0));
    let note = Defect::CoincidentVertices {
        exact: 28,
        near: 0,
        tolerance: 1e-7,
        components: 1,
        boundary_edges: 0,
        non_manifold_edges: 0,
    };
    assert!(report.defects.contains(&note), "{report:?}");
    let summary = &report.summaries()[0];
    assert_eq!(
        summary.text,
        "28 vertices lie at the place of another (and 0 within 1e-7 of the size; welding \
         would leave 1 component and 0 boundary edges)"
    );
    assert_eq!(summary.advice, "--weld does it");
    // Of a closed connected surface, and of one without seams, there is nothing to say.
    for soup in [cube(), grid(3, 2), welded(unwelded(&cube(), 0.0), 0.0)] {
        let (_, report) = mesh_of(soup);
        let kinds = report.defects.iter().map(Defect::kind);
        assert!(kinds.clone().all(|kind| kind == DefectKind::WeldedVertices));
    }
}

#[test]
fn edges_of_many_faces_that_welding_makes_are_noted() {
    // Two cubes that share an edge.
    let mut soup = cube();
    let second = cube();
    soup.positions.extend(
        second
            .positions
            .iter()
            .map(|[x, y, z]| [x + 1.0, y + 1.0, *z]),
    );
    soup.triangles
        .extend(second.triangles.iter().map(|t| t.map(|v| v + 8)));
    let (_, report) = mesh_of(soup.clone());
    assert!(
        report.summaries()[0]
            .text
            .contains("1 edge of more than two faces")
    );
    let (mesh, report) = mesh_of(welded(soup, 0.0));
    let texts: Vec<String> = report.summaries().into_iter().map(|s| s.text).collect();
    assert!(
        texts[0].contains("1 edge has more than two faces"),
        "{texts:?}"
    );
    assert!(
        texts[1].contains("2 vertices were welded to others"),
        "{texts:?}"
    );
    assert_eq!(mesh.junction_sides().len(), 4);
}

#[test]
fn cracked_models_close() {
    let cases = Path::new("../../../shared/cases/meshes");
    if !cases.exists() {
        return;
    }
    for (name, tolerance, components, boundary_edges) in [
        ("b3_t_lastbit_cracks.stl", 1e-6, None, 0),
        ("idler_riser_crack_19x.stl", 1e-6, None, 0),
        // An open sheet of 12 by 12 squares, whose outline remains.
        ("stl_two_roundings.stl", 1e-4, Some(1), 48),
        ("cubevt_unwelded.obj", 0.0, Some(1), 0),
    ] {
        let soup = io::read(&cases.join(name)).unwrap();
        let found = measures(welded(soup, tolerance));
        assert_eq!(found.boundary_edges, boundary_edges, "{name}");
        assert_eq!(
            found.components,
            components.unwrap_or(found.components),
            "{name}"
        );
    }
    for name in [
        "degenerate_stl_cr7ial_link_4.stl",
        "mc_octahedron_exact_zeros.obj",
    ] {
        let found = measures(io::read(&cases.join(name)).unwrap());
        assert_eq!((found.components, found.boundary_edges), (1, 0), "{name}");
    }
}

/// Halves of a sheet that were written with six and with seven decimals lie 2e-7 of the size apart.
#[test]
fn cracks_of_any_rounding_are_noted() {
    let rounded = |decimals: i32| {
        let mut soup = grid(6, 6);
        let unit = 10f64.powi(decimals);
        for x in soup.positions.as_flattened_mut() {
            *x = (*x / 6.0 * unit).round() / unit;
        }
        soup
    };
    let (mut sheet, fine) = (rounded(6), rounded(7));
    let copies = sheet.positions.len() as u32;
    sheet.positions.extend(fine.positions);
    for triangle in &mut sheet.triangles[36..] {
        *triangle = triangle.map(|v| v + copies);
    }
    let (_, report) = mesh_of(sheet.clone());
    let is_note = |defect: &&Defect| defect.kind() == DefectKind::CoincidentVertices;
    let expected = Defect::CoincidentVertices {
        exact: 3, // 0, 1/2 and 1 are written alike.
        near: 4,
        tolerance: 1e-6,
        components: 1,
        boundary_edges: 24,
        non_manifold_edges: 0,
    };
    assert_eq!(report.defects.iter().find(is_note), Some(&expected));
    let summaries = report.summaries();
    let note = summaries
        .iter()
        .find(|s| s.kind == DefectKind::CoincidentVertices);
    assert_eq!(note.unwrap().advice, "--weld=1e-6 does it");
    let closed = measures(welded(sheet, 1e-6));
    assert_eq!((closed.components, closed.boundary_edges), (1, 24));
    // A fine boundary is no crack.
    let mut fan = grid(1, 1);
    fan.positions.push([1.0, 1.000_001, 0.0]);
    fan.triangles.push([2, 3, 4]);
    let (_, report) = mesh_of(fan);
    assert_eq!(report.defects.iter().find(is_note), None);
}

/// A file with polygons, in the form of OFF.
struct Polygons {
    places: Vec<[f64; 3]>,
    faces: Vec<Vec<u32>>,
}

impl Polygons {
    /// A warped sheet of quads, so that each of the two ways to cut one makes another surface.
    fn sheet() -> Self {
        let mut random = SplitMix64::new(7);
        let mut place = |i: u32| [f64::from(i % 4), f64::from(i / 4), 2.0 * random.unit()];
        let places = (0..16).map(&mut place).collect();
        let quad = |i: u32| vec![i, i + 1, i + 5, i + 4];
        let faces = (0..11).filter(|i| i % 4 < 3).map(quad).collect();
        Self { places, faces }
    }

    /// Places of the corners of the triangles that the file becomes, in ascending order.
    fn surface(&self, weld: Option<Weld>) -> Vec<[[u64; 3]; 3]> {
        let mut text = format!("OFF\n{} {} 0\n", self.places.len(), self.faces.len());
        for [x, y, z] in &self.places {
            writeln!(text, "{x:?} {y:?} {z:?}").unwrap();
        }
        for face in &self.faces {
            let corners: Vec<String> = face.iter().map(u32::to_string).collect();
            writeln!(text, "{} {}", face.len(), corners.join(" ")).unwrap();
        }
        let options = io::ReadOptions {
            weld,
            ..io::ReadOptions::default()
        };
        let soup = options.read_bytes(text.as_bytes(), io::Format::Off, Path::new("a.off"));
        let (mesh, _) = mesh_of(soup.unwrap());
        let place = |v: VertexId| mesh.positions()[v.index()].map(f64::to_bits);
        let mut surface: Vec<_> = (mesh.faces())
            .map(|f| {
                let mut corners = mesh.face_vertices(f).map(place);
                corners.sort_unstable();
                corners
            })
            .collect();
        surface.sort_unstable();
        surface
    }

    /// A copy of a random corner's vertex, which some of its faces name instead.
    fn split(&mut self, random: &mut SplitMix64) -> (usize, [u32; 2]) {
        let face = random.below(self.faces.len());
        let corner = random.below(self.faces[face].len());
        let vertex = self.faces[face][corner];
        let copy = self.places.len() as u32;
        self.places.push(self.places[vertex as usize]);
        for other in self.faces.iter_mut().flatten() {
            if *other == vertex && random.below(2) == 0 {
                *other = copy;
            }
        }
        (face, [vertex, copy])
    }

    /// Adds a defect of the given kind, which leaves the surface as it is.
    fn damage(&mut self, kind: usize, random: &mut SplitMix64) {
        let face = random.below(self.faces.len());
        let corner = random.below(self.faces[face].len());
        match kind {
            // Copies along a seam.
            0 => {
                self.split(random);
            }
            // An edge of no length, in a polygon or a face of its own.
            1 => {
                let (face, [vertex, copy]) = self.split(random);
                let outline = &mut self.faces[face];
                let at = outline.iter().position(|&v| v == vertex || v == copy);
                if let (Some(at), true) = (at, random.below(2) == 0) {
                    let other = vertex + copy - outline[at];
                    outline.insert(at + random.below(2), other);
                    // A first corner in place of the former first one is at its place.
                } else {
                    let third = self.faces[(face + 1) % self.faces.len()][0];
                    self.faces.push(vec![vertex, copy, third]);
                }
            }
            // A corner given twice, or a first one also at the end.
            2 => {
                let vertex = self.faces[face][corner];
                self.faces[face].insert(corner, vertex);
            }
            3 => {
                let first = self.faces[face][0];
                self.faces[face].push(first);
            }
            // A second copy, from another corner and in either direction.
            4 => {
                let mut copy = self.faces[face].clone();
                copy.rotate_left(corner);
                if random.below(2) == 0 {
                    copy.reverse();
                }
                self.faces.push(copy);
            }
            // Faces that are a segment.
            _ => {
                let [a, b] = [0, 1].map(|k| self.faces[face][k]);
                self.faces
                    .push([vec![a, b, a], vec![a, b, b, a]][corner % 2].clone());
            }
        }
    }
}

/// Edges of no length became one vertex only after polygons had been cut, so that a copy of a
/// polygon was cut along the other diagonal, or a cut of a polygon was one of its neighbour.
#[test]
fn cuts_do_not_depend_on_other_defects() {
    let sheet = Polygons::sheet().surface(None);
    for seed in 0..400 {
        let mut random = SplitMix64::new(seed);
        let mut file = Polygons::sheet();
        let mut weld = None;
        for _ in 0..=random.below(6) {
            let kind = random.below(6);
            file.damage(kind, &mut random);
            if kind == 0 {
                weld = Some(Weld::COINCIDENT);
            }
        }
        assert!(file.surface(weld) == sheet, "{seed}: {:?}", file.faces);
    }
}

#[test]
fn a_line_of_no_length_joins_nothing() {
    let places = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0; 3]];
    let soup = io::polygons(places, [&[0, 1, 2][..], &[0, 3]]).unwrap();
    assert_eq!(soup.copies, Vec::<[u32; 2]>::new());
}
