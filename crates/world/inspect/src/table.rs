//! The inspection as text.

use std::fmt;

use elbowroom_kinematics::JointKind;

use crate::inspection::{Inspection, ModelKind};
use crate::pairs::ReasonKind;
use crate::resolution_levels::TrianglesRow;
use crate::text::shortened;

impl fmt::Display for Inspection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (links, joints, dof) = (self.links.len(), self.joints.len(), self.dof);
        let triangles: usize = self.meshes.iter().map(|m| m.triangles).sum();
        match self.kind {
            ModelKind::Robot => writeln!(
                f,
                "{}: {links} links, {joints} joints, {dof} degrees of freedom, {triangles} triangles",
                self.name
            )?,
            ModelKind::Mesh => writeln!(f, "{}: {links} objects, {triangles} triangles", self.name)?,
        }
        self.fmt_joints(f)?;
        self.fmt_meshes(f)?;
        self.fmt_levels(f)?;
        self.fmt_resolution(f)?;
        self.fmt_pairs(f)?;
        write!(f, "{}", self.dh)?;
        if !self.warnings.is_empty() {
            writeln!(f, "\nNote")?;
        }
        self.warnings.iter().try_for_each(|w| writeln!(f, "  {}", w.replace('\n', "\n  ")))
    }
}

impl Inspection {
    fn fmt_joints(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.joints.is_empty() {
            return Ok(());
        }
        writeln!(f, "\n{:24} {:10} {:>9} {:>9} {:>9}  moves", "Joint (deg, m)", "type", "lower", "upper", "speed")?;
        for j in &self.joints {
            let number = |v: Option<f64>| v.map_or("-".into(), |v| format!("{:.3}", in_user_units(v, j.kind)));
            let follows = j.mimic.as_ref().map(|m| format!(", follows {m}")).unwrap_or_default();
            let (lower, upper, speed) = (number(j.lower), number(j.upper), number(j.velocity));
            writeln!(
                f,
                "{:24} {:10} {lower:>9} {upper:>9} {speed:>9}  {}{follows}",
                shortened(&j.name, 24),
                j.kind_name(),
                j.child
            )?;
        }
        Ok(())
    }

    fn fmt_meshes(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.meshes.is_empty() {
            return Ok(());
        }
        writeln!(f, "\n{:24} {:>9} {:>10} {:>10}  extent (m)", "Mesh of", "triangles", "closed", "degenerate")?;
        for m in &self.meshes {
            let [x, y, z] = m.extent_m;
            let closed = match (m.closed, m.open_edges) {
                (true, _) => "yes".into(),
                (false, 0) => "non-manifold".into(),
                (false, edges) => format!("open {edges}"),
            };
            let (link, n, bad) = (shortened(&m.link, 24), m.triangles, m.degenerate);
            writeln!(f, "{link:24} {n:>9} {closed:>10} {bad:>10}  {x:.3} x {y:.3} x {z:.3}")?;
        }
        for m in self.meshes.iter().filter(|m| m.welded_vertices > 0) {
            writeln!(
                f,
                "  `{}`: {} vertices on seams within {:.1e} m of another count as one: containment is tested with them merged, \
                 distances refer to the original faces",
                m.name, m.welded_vertices, m.weld_tolerance_m
            )?;
        }
        Ok(())
    }

    fn fmt_levels(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.levels.is_empty() {
            return Ok(());
        }
        writeln!(f, "\n{:24} {:10} times the hull's volume", "Level L2 of", "volume")?;
        for l in &self.levels {
            let ratio = l.ratio_to_hull.map_or("-".into(), |r| format!("{r:.2}"));
            writeln!(f, "{:24} {:10} {ratio}", shortened(&l.link, 24), l.volume)?;
        }
        Ok(())
    }

    fn fmt_resolution(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let with_triangles = || self.resolution.iter().filter(|l| l.fine.is_some());
        if with_triangles().next().is_none() {
            return Ok(());
        }
        writeln!(f, "\n{:24} {:>8} {:>20} {:>20} {:>8}", "Triangles of", "fine", "middle", "coarse", "hull")?;
        for l in with_triangles() {
            let fine = l.fine.as_ref().map_or(0, |r| r.triangles);
            let hull = l.hull.as_ref().map_or("flat".into(), |h| h.triangles.to_string());
            let (link, middle, coarse) = (shortened(&l.link, 24), off(l.middle.as_ref()), off(l.coarse.as_ref()));
            writeln!(f, "{link:24} {fine:>8} {middle:>20} {coarse:>20} {hull:>8}")?;
        }
        Ok(())
    }

    fn fmt_pairs(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.pairs.is_empty() {
            return Ok(());
        }
        let tested = self.pairs.iter().filter(|p| p.tested).count();
        writeln!(f, "\n{tested} of {} pairs of links are tested for collisions", self.pairs.len())?;
        let mut kinds: Vec<ReasonKind> = Vec::new();
        for p in &self.pairs {
            if !kinds.contains(&p.kind) {
                kinds.push(p.kind);
            }
        }
        for kind in kinds {
            let of_kind = || self.pairs.iter().filter(|p| p.kind == kind);
            let does = if of_kind().all(|p| p.tested) { "tested" } else { "skipped" };
            writeln!(f, "{:>6} {does}: {kind}", of_kind().count())?;
        }
        Ok(())
    }
}

/// Number of triangles and the bound on their deviation, in millimetres.
fn off(row: Option<&TrianglesRow>) -> String {
    let Some(row) = row else { return "-".into() };
    let off = row.deviation_m.map_or("?".into(), |d| format!("{:.2}", 1000.0 * d));
    format!("{} (off {off} mm)", row.triangles)
}

fn in_user_units(v: f64, kind: JointKind) -> f64 {
    if kind == JointKind::Prismatic { v } else { v.to_degrees() }
}
