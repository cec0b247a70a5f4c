//! Runs from and to points that are no vertices, without a new set-up.

use geobench_mesh::{Insertion, Mesh, Refined};

use crate::solver::Solver;

/// Calls `run` with a solver of the mesh in which the points of `insertion` are vertices, and with
/// that mesh: with `solver`, set up for the original mesh, if it can [change](Solver::splice) its
/// mesh in place, else with the one that `set_up` makes for the refined mesh.
///
/// Afterwards `solver` is as before. Nothing but the data of the faces around the points changes,
/// so every rule of the algorithm holds as on a mesh that is refined first. The first call copies
/// the data of the mesh, and so does each one after clones of the refined mesh have outlived `run`.
///
/// ```
/// use geobench_ich::ich;
/// use geobench_mesh::Mesh;
/// use geobench_window::{Solver, at_points};
///
/// let mesh = Mesh::generate("grid,n=4")?;
/// let mut solver = ich(&mesh);
/// let middle = mesh.point_in_face(0.into(), [0.25, 0.25, 0.5])?;
/// let set_up = |mesh: &Mesh| -> Box<dyn Solver> { Box::new(ich(mesh)) };
/// let solution = at_points(&mut solver, mesh.insertion(&[middle])?, set_up, |solver, refined| {
///     solver.solve(&refined.vertices)
/// });
/// assert_eq!(solution?.distances.len(), mesh.vertex_count() + 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn at_points<T>(
    solver: &mut dyn Solver,
    insertion: Insertion,
    set_up: impl FnOnce(&Mesh) -> Box<dyn Solver>,
    run: impl FnOnce(&mut dyn Solver, &Refined) -> T,
) -> T {
    let mut mesh = insertion.original().clone();
    if insertion.is_empty() {
        return run(solver, &insertion.into_refined(mesh));
    }
    if let Some((mesh, undo)) = solver.splice(insertion.splice()) {
        let refined = insertion.into_refined(mesh);
        let result = run(solver, &refined);
        // A clone of the changed mesh would have to be copied.
        drop(refined);
        solver.splice(&undo);
        return result;
    }
    mesh.splice(insertion.splice());
    let refined = insertion.into_refined(mesh);
    run(&mut *set_up(&refined.mesh), &refined)
}
