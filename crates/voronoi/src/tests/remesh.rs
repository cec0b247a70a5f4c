//! Remeshing of whole surfaces.

use geobench_mesh::{Mesh, MeshMeasures, TriangleSoup, VertexId};
use geobench_vtp::VtpFast;
use geobench_window::Solver;

use crate::{Quality, RemeshError, RemeshOptions, Remeshed, SurfaceDeviation, remesh};

fn remeshed(spec: &str, sites: usize, lloyd: usize) -> (Mesh, Remeshed) {
    let mesh = Mesh::generate(spec).unwrap();
    let options = RemeshOptions {
        sites,
        lloyd,
        seed: 0,
    };
    let new = remesh(&mesh, &options).unwrap_or_else(|e| panic!("{spec}: {e}"));
    new.mesh.sanity_check().unwrap();
    assert_eq!(new.mesh.vertex_count(), new.sites.len(), "{spec}");
    (mesh, new)
}

/// Components, genus, boundary loops.
fn topology(mesh: &Mesh) -> [usize; 3] {
    let measures = MeshMeasures::of(mesh);
    [measures.components, measures.genus, measures.boundary_loops]
}

#[test]
fn the_new_mesh_has_the_topology_of_the_surface() {
    let cases = [
        ("sphere,subdiv=4", 100, [1, 0, 0]),
        ("torus,faces=3000", 200, [1, 1, 0]),
        ("knot,faces=6000", 300, [1, 1, 0]),
        ("grid,n=20", 60, [1, 0, 1]),
        ("terrain,n=30,seed=1", 100, [1, 0, 1]),
        ("cube,n=12", 80, [1, 0, 0]),
    ];
    for (spec, sites, expected) in cases {
        for lloyd in [0, 3] {
            let (mesh, new) = remeshed(spec, sites, lloyd);
            assert_eq!(topology(&mesh), expected, "{spec}");
            assert_eq!(topology(&new.mesh), expected, "{spec}, {lloyd} steps");
            // Symmetric surfaces have cells that share several borders.
            assert!(new.added <= 4, "{spec}: {} added", new.added);
            assert_eq!(new.moved.len(), lloyd);
        }
    }
}

#[test]
fn sites_are_added_where_there_are_too_few_for_discs() {
    for (spec, sites, topology_of) in [
        ("sphere,subdiv=3", 1, [1, 0, 0]),
        ("torus,faces=3000", 2, [1, 1, 0]),
        ("knot,faces=6000", 20, [1, 1, 0]),
        ("grid,n=12", 1, [1, 0, 1]),
        ("holes,holes=2", 5, [1, 0, 5]),
    ] {
        let (_, new) = remeshed(spec, sites, 1);
        assert!(
            new.added > 0 && new.sites.len() == sites + new.added,
            "{spec}"
        );
        assert_eq!(topology(&new.mesh), topology_of, "{spec}");
    }
}

#[test]
fn each_site_is_farthest_from_those_before_it() {
    let (mesh, new) = remeshed("torus,faces=2000,bump=0.2,seed=3", 40, 0);
    let mut solver = VtpFast::new(&mesh);
    let sites: Vec<VertexId> = new.sites.iter().map(|s| s.vertex().unwrap()).collect();
    for k in 1..sites.len() {
        let distances = solver.solve(&sites[..k]).unwrap().distances;
        let farthest = distances.iter().copied().fold(0.0, f64::max);
        let taken = distances[sites[k].index()];
        assert!(
            (taken - farthest).abs() <= 1e-12 * farthest,
            "{k}: {taken} of {farthest}"
        );
    }
}

#[test]
fn sites_on_the_boundary_reach_all_of_it_and_stay() {
    let (mesh, new) = remeshed("grid,n=24", 120, 4);
    let corners = [[0.0, 0.0], [24.0, 0.0], [24.0, 24.0], [0.0, 24.0]];
    let spacing = (2.0 * 576.0 / (3.0_f64.sqrt() * 120.0)).sqrt();
    for corner in corners {
        let off = new.mesh.positions().iter();
        let off = off.map(|p| (p[0] - corner[0]).hypot(p[1] - corner[1]));
        assert!(off.fold(f64::INFINITY, f64::min) < 1e-12, "{corner:?}");
    }
    let deviation = SurfaceDeviation::between(&mesh, &new.mesh, 5000).unwrap();
    assert!(deviation.greatest < 0.5 * spacing, "{deviation:?}");
    assert!(
        SurfaceDeviation::between(&new.mesh, &mesh, 5000)
            .unwrap()
            .greatest
            < 1e-12
    );
    assert!((MeshMeasures::of(&new.mesh).area - 576.0).abs() < 6.0);
}

/// The sum over the vertices of the squares of their distances from the nearest site, weighted by
/// area.
fn energy(new: &Remeshed) -> f64 {
    let mesh = new.diagram.mesh();
    let sites: Vec<VertexId> = (0..new.sites.len())
        .map(|i| {
            let position = new.mesh.positions()[i];
            let apart = |v: &VertexId| {
                let p = mesh.positions()[v.index()];
                (0..3).map(|k| (p[k] - position[k]).powi(2)).sum::<f64>()
            };
            let all = mesh.vertices();
            all.min_by(|a, b| apart(a).total_cmp(&apart(b))).unwrap()
        })
        .collect();
    let distances = VtpFast::new(mesh).solve(&sites).unwrap().distances;
    let area = |face: geobench_mesh::FaceId| {
        let h = face.half_edge(0);
        0.5 * mesh.length(h) * mesh.apex(h)[1]
    };
    let squares = |face| {
        let corners = mesh.face_vertices(face).into_iter();
        corners.map(|v| distances[v.index()].powi(2)).sum::<f64>() / 3.0
    };
    mesh.faces().map(|face| area(face) * squares(face)).sum()
}

#[test]
fn steps_to_the_centres_lower_the_energy_and_make_better_triangles() {
    for spec in ["sphere,subdiv=5", "torus,faces=9600"] {
        let (_, before) = remeshed(spec, 150, 0);
        let (_, one) = remeshed(spec, 150, 1);
        let (_, ten) = remeshed(spec, 150, 10);
        let energies = [&before, &one, &ten].map(energy);
        assert!(energies[1] < 0.985 * energies[0], "{spec}: {energies:?}");
        assert!(energies[2] < 0.985 * energies[1], "{spec}: {energies:?}");
        let [first, last] = [&before, &ten].map(|new| Quality::of(&new.mesh));
        assert!(
            last.mean_least_angle > first.mean_least_angle + 1.0,
            "{spec}: {first:?}, {last:?}"
        );
        assert!(
            last.below_30 <= first.below_30 && last.least_angle > 25.0,
            "{spec}: {last:?}"
        );
        assert!(ten.moved[9] < 0.3 * ten.moved[0], "{spec}: {:?}", ten.moved);
    }
}

#[test]
fn the_same_seed_gives_the_same_mesh() {
    let [(_, first), (_, second)] = [0; 2].map(|_| remeshed("knot,faces=4000", 150, 2));
    assert_eq!(first.soup(), second.soup());
    let mesh = Mesh::generate("knot,faces=4000").unwrap();
    let options = RemeshOptions {
        sites: 150,
        lloyd: 2,
        seed: 1,
    };
    assert_ne!(remesh(&mesh, &options).unwrap().soup(), first.soup());
}

#[test]
fn every_component_gets_a_mesh() {
    let mut soup = TriangleSoup::new(Vec::new(), Vec::new());
    for (spec, shift) in [("sphere,subdiv=3", 0.0), ("torus,faces=1000", 10.0)] {
        let mesh = Mesh::generate(spec).unwrap();
        let first = soup.positions.len() as u32;
        let moved = mesh.positions().iter().map(|p| [p[0] + shift, p[1], p[2]]);
        soup.positions.extend(moved);
        let faces = mesh.faces().map(|f| mesh.face_vertices(f));
        let corners = faces.map(|corners| corners.map(|v| v.raw() + first));
        soup.triangles.extend(corners);
    }
    let (mesh, _) = Mesh::from_soup(soup).unwrap();
    for sites in [1, 200] {
        let options = RemeshOptions {
            sites,
            lloyd: 1,
            seed: 5,
        };
        match remesh(&mesh, &options) {
            Ok(new) => assert_eq!(topology(&new.mesh), [2, 1, 0], "{sites}"),
            Err(error) => panic!("{sites}: {error}"),
        }
    }
}

#[test]
fn impossible_remeshing_is_refused() {
    let mesh = Mesh::generate("cube,n=1").unwrap();
    let options = |sites| RemeshOptions {
        sites,
        lloyd: 0,
        seed: 0,
    };
    for sites in [0, 9] {
        let error = remesh(&mesh, &options(sites)).unwrap_err();
        assert!(
            matches!(error, RemeshError::Sites { vertices: 8, .. }),
            "{error}"
        );
    }
    assert_eq!(
        topology(&remesh(&mesh, &options(8)).unwrap().mesh),
        [1, 0, 0]
    );
    let lengths = vec![[1.0; 3]];
    let (bare, _) = Mesh::from_lengths(3, &[[0, 1, 2]], &lengths).unwrap();
    let error = remesh(&bare, &options(3)).unwrap_err();
    assert!(matches!(error, RemeshError::NoSurface), "{error}");
    // A triangle has no vertices left for a fourth site, nor needs one.
    let triangle = Mesh::new(
        vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        vec![[0, 1, 2]],
    );
    let triangle = triangle.unwrap();
    assert_eq!(remesh(&triangle, &options(3)).unwrap().mesh.face_count(), 1);
}
