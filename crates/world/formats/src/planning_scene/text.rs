//! The `.scene` text: a name, objects that begin with `*`, and a line with a dot.
//!
//! In the newer version, objects have a pose and subframes. A line of four colour components follows each shape.

use std::path::Path;
use std::sync::Arc;

use elbowroom_proximity::{Cuboid, Cylinder, Shape, Sphere, TriMesh};
use elbowroom_spatial::{Pose, Vec3};

use super::scene::PlanningScene;
use crate::Diagnostic;
use crate::moveit_msgs::types::CollisionObject;
use crate::moveit_msgs::{object, pose, solid};
use crate::tokens::{Lines, Tokens, number, show, show_name};
use crate::warning_list::WarningList;

const OBJECT: &str = "* NAME, and on the next lines its position, its quaternion, and the number of its shapes";
const END: &str = "a last line with a dot: the file may be truncated, save it again";
/// The shortest text of a vertex or triangle: `0 0 0` and a line ending.
const MIN_ROW_BYTES: usize = 6;

/// True for a text of this form. YAML lines never begin with an asterisk and a blank.
pub(super) fn is_scene_text(text: &str, file: &Path) -> bool {
    let is_marker = |line: &str| line.starts_with("* ") || line == ".";
    file.extension().is_some_and(|e| e.eq_ignore_ascii_case("scene"))
        || text.lines().skip(1).any(|l| is_marker(l.trim_end()))
}

pub(super) fn parse(text: &str, file: &Path) -> Result<PlanningScene, Diagnostic> {
    let mut tokens = Tokens::new(text.as_bytes());
    let name = String::from_utf8_lossy(tokens.rest_of_line()).into_owned();
    let mut reader =
        SceneText { file, tokens, has_object_poses: has_object_poses(text), warnings: WarningList::default() };
    let objects = reader.objects()?;
    if let Some(id) = object::duplicate(objects.iter()) {
        let what = format!("has two objects `{}`", show_name(id));
        return Err(Diagnostic::new(file, None, what).hint("a name of its own for each object"));
    }
    Ok(PlanningScene { name, objects, warnings: reader.warnings.finish(file), ..PlanningScene::default() })
}

/// True for the newer version: the line after the first name is a position, in the older version a number of shapes.
fn has_object_poses(text: &str) -> bool {
    let mut lines = Lines::new(text.as_bytes()).map(|(_, line)| line.trim_ascii());
    let is_name = |line: &[u8]| line.starts_with(b"*");
    lines
        .find(|l| is_name(l))
        .and_then(|_| lines.find(|l| !l.is_empty()))
        .is_some_and(|l| l.contains(&b' ') || l.contains(&b'\t'))
}

struct SceneText<'a> {
    file: &'a Path,
    tokens: Tokens<'a>,
    has_object_poses: bool,
    warnings: WarningList,
}

impl<'a> SceneText<'a> {
    fn objects(&mut self) -> Result<Vec<CollisionObject>, Diagnostic> {
        let mut objects = Vec::new();
        loop {
            match self.tokens.next() {
                Some(b"*") => {
                    let (line, object) = (self.tokens.line(), self.object()?);
                    if object.solids.is_empty() {
                        let what = format!("the object `{}` has no shape: left out", show_name(&object.id));
                        self.warnings.push(Diagnostic::new(self.file, line, what));
                    } else {
                        objects.push(object);
                    }
                }
                Some(b".") => break,
                Some(word) => {
                    let what = format!("has `{}` where an object begins", show(word));
                    return Err(self.error(what, OBJECT));
                }
                None => return Err(self.error("has no end", END)),
            }
        }
        if let Some(word) = self.tokens.next() {
            let what = format!("has `{}` behind the dot that ends it: ignored", show(word));
            self.warnings.push(Diagnostic::new(self.file, self.tokens.line(), what));
        }
        Ok(objects)
    }

    fn object(&mut self) -> Result<CollisionObject, Diagnostic> {
        let id = String::from_utf8_lossy(self.tokens.rest_of_line()).into_owned();
        if id.is_empty() {
            return Err(self.error("has an object without a name", OBJECT));
        }
        let of = show_name(&id);
        let in_frame = if self.has_object_poses { self.pose(&of)? } else { Pose::IDENTITY };
        let mut solids = Vec::new();
        for _ in 0..self.count("shapes", &of)? {
            let (shape, in_shape) = self.shape(&of)?;
            let in_object = self.pose(&of)?;
            self.numbers(["r", "g", "b", "a"], &format!("the colour of `{of}`"))?;
            solids.push((shape, in_frame * in_object * in_shape));
        }
        if self.has_object_poses {
            for _ in 0..self.count("subframes", &of)? {
                self.word(&format!("`{of}` has no name of a subframe"), "NAME")?;
                self.pose(&of)?;
            }
        }
        Ok(CollisionObject { id, frame: String::new(), solids })
    }

    /// Reads a shape, and its pose in the frame whose pose the file states.
    fn shape(&mut self, of: &str) -> Result<(Shape, Pose), Diagnostic> {
        const SHAPES: &str = "box, sphere, cylinder, cone, plane or mesh";
        let word = self.word(&format!("`{of}` has fewer shapes than it says"), SHAPES)?;
        let shape = match word {
            b"box" => {
                let [x, y, z] = self.sizes(["x", "y", "z"], of)?;
                Shape::Cuboid(Cuboid { half_extents: Vec3::new(x, y, z) * 0.5 })
            }
            b"sphere" => {
                let [radius] = self.sizes(["radius"], of)?;
                Shape::Sphere(Sphere { radius })
            }
            b"cylinder" | b"cone" => {
                let line = self.tokens.line();
                let [radius, length] = self.sizes(["radius", "length"], of)?;
                if word == b"cone" {
                    let what = format!("the object `{of}` {}", solid::CONE);
                    self.warnings.push(Diagnostic::new(self.file, line, what));
                }
                Shape::Cylinder(Cylinder { half_length: 0.5 * length, radius })
            }
            b"plane" => {
                let coefficients = self.numbers(["a", "b", "c", "d"], &format!("the plane of `{of}`"))?;
                let none = || self.error(format!("the plane of `{of}` has no direction"), "a b c d: 0 0 1 0");
                return solid::half_space(coefficients).ok_or_else(none);
            }
            b"mesh" => Shape::Mesh(Arc::new(self.mesh(of)?)),
            _ => return Err(self.error(format!("`{}` is no shape", show(word)), SHAPES)),
        };
        Ok((shape, Pose::IDENTITY))
    }

    fn mesh(&mut self, of: &str) -> Result<TriMesh, Diagnostic> {
        let [vertices, triangles] = [self.count("vertices", of)?, self.count("triangles", of)?];
        let bytes = self.tokens.rest().len();
        if (vertices + triangles).saturating_mul(MIN_ROW_BYTES) > bytes {
            let what = format!("`{of}` has {vertices} vertices and {triangles} triangles, but {bytes} bytes follow");
            return Err(self.error(what, END));
        }
        let line = self.tokens.line();
        let vertex = |reader: &mut Self| reader.position(&format!("a vertex of `{of}`"));
        let vertices = (0..vertices).map(|_| vertex(self)).collect::<Result<Vec<_>, _>>()?;
        let corner = |reader: &mut Self| reader.whole("a corner", of);
        let triangle = |reader: &mut Self| Ok([corner(reader)?, corner(reader)?, corner(reader)?]);
        let triangles = (0..triangles).map(|_| triangle(self)).collect::<Result<Vec<_>, _>>()?;
        TriMesh::new(vertices, triangles).map_err(|e| {
            let what = format!("the mesh of `{of}` is no solid: {e}");
            Diagnostic::new(self.file, line, what).hint("the numbers of vertices and triangles, then x y z and i j k")
        })
    }

    fn error(&self, what: impl std::fmt::Display, hint: &str) -> Diagnostic {
        Diagnostic::new(self.file, self.tokens.line(), what).hint(hint)
    }

    fn word(&mut self, missing: &str, hint: &str) -> Result<&'a [u8], Diagnostic> {
        let word = self.tokens.next();
        word.ok_or_else(|| self.error(missing, hint))
    }

    fn numbers<const N: usize>(&mut self, names: [&str; N], of: &str) -> Result<[f64; N], Diagnostic> {
        let mut numbers = [0.0; N];
        for (value, name) in numbers.iter_mut().zip(names) {
            let word = self.word(&format!("{of} has no {name}"), END)?;
            let parsed = number(word).filter(|v| v.is_finite());
            *value = parsed.ok_or_else(|| {
                let what = format!("`{}` is no finite number, for {name} of {of}", show(word));
                self.error(what, &format!("{N} numbers: {}", names.join(" ")))
            })?;
        }
        Ok(numbers)
    }

    fn sizes<const N: usize>(&mut self, names: [&str; N], of: &str) -> Result<[f64; N], Diagnostic> {
        let sizes = self.numbers(names, &format!("`{of}`"))?;
        match sizes.iter().position(|v| !solid::is_size(*v)) {
            Some(i) => Err(self.error(format!("`{of}` has {} as {}", sizes[i], names[i]), "metres, 0 or more")),
            None => Ok(sizes),
        }
    }

    fn position(&mut self, of: &str) -> Result<Vec3, Diagnostic> {
        let point = Vec3::from(self.numbers(["x", "y", "z"], of)?);
        let far = || self.error(format!("{of} has a coordinate above 1e9 m"), "coordinates in metres");
        if pose::is_position(point) { Ok(point) } else { Err(far()) }
    }

    fn pose(&mut self, of: &str) -> Result<Pose, Diagnostic> {
        let translation = self.position(&format!("the position of `{of}`"))?;
        let rotation = pose::rotation(self.numbers(["x", "y", "z", "w"], &format!("the quaternion of `{of}`"))?);
        let none =
            || self.error(format!("the quaternion of `{of}` has no direction"), "x y z w: 0 0 0 1 for no rotation");
        Ok(Pose::new(rotation.ok_or_else(none)?, translation))
    }

    fn whole(&mut self, name: &str, of: &str) -> Result<u32, Diagnostic> {
        let word = self.word(&format!("`{of}` has no {name}"), END)?;
        let parsed = std::str::from_utf8(word).ok().and_then(|w| w.parse().ok());
        parsed.ok_or_else(|| {
            let what = format!("`{}` is no whole number, for {name} of `{of}`", show(word));
            self.error(what, "0, 1, 2, …")
        })
    }

    fn count(&mut self, name: &str, of: &str) -> Result<usize, Diagnostic> {
        self.whole(&format!("number of {name}"), of).map(|n| n as usize)
    }
}
