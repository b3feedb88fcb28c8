//! Writer of an SRDF as text.

use std::fmt::{self, Write};

use super::model::Srdf;
use crate::xml::escaped;

impl Srdf {
    /// Writes the text of the SRDF, followed by comments. Warnings and line numbers are not written.
    ///
    /// ```
    /// use elbowroom_formats::srdf::{self, DisabledPair, Group, Srdf};
    /// let pair = DisabledPair { link1: "a".into(), link2: "b".into(), reason: "Adjacent".into(), line: 0 };
    /// let group = Group { name: "arm".into(), chains: vec![["a".into(), "b".into()]], ..Group::default() };
    /// let srdf = Srdf { robot: Some("arm".into()), groups: vec![group], disabled: vec![pair], ..Srdf::default() };
    /// let text = srdf.text(&["c and d are still tested".to_owned()]);
    /// let again = srdf::parse(text.as_bytes(), "arm.srdf".as_ref())?;
    /// assert_eq!((&again.groups, &again.disabled[0].link2[..]), (&srdf.groups, "b"));
    /// assert!(text.contains("<!-- c and d are still tested -->"));
    /// # Ok::<(), elbowroom_formats::Diagnostic>(())
    /// ```
    pub fn text(&self, comments: &[String]) -> String {
        let mut out = String::new();
        // Writing to a String cannot fail.
        let _ = self.write(comments, &mut out);
        out
    }

    fn write(&self, comments: &[String], out: &mut String) -> fmt::Result {
        let robot = self.robot.as_deref().unwrap_or_default();
        writeln!(out, "<?xml version=\"1.0\"?>\n<robot name=\"{}\">", escaped(robot))?;
        for group in &self.groups {
            writeln!(out, "  <group name=\"{}\">", escaped(&group.name))?;
            for (element, names) in [("link", &group.links), ("joint", &group.joints), ("group", &group.subgroups)] {
                for name in names {
                    writeln!(out, "    <{element} name=\"{}\"/>", escaped(name))?;
                }
            }
            for [base, tip] in &group.chains {
                writeln!(out, "    <chain base_link=\"{}\" tip_link=\"{}\"/>", escaped(base), escaped(tip))?;
            }
            writeln!(out, "  </group>")?;
        }
        for state in &self.states {
            writeln!(out, "  <group_state name=\"{}\" group=\"{}\">", escaped(&state.name), escaped(&state.group))?;
            for (joint, value) in &state.values {
                writeln!(out, "    <joint name=\"{}\" value=\"{value:?}\"/>", escaped(joint))?;
            }
            writeln!(out, "  </group_state>")?;
        }
        for e in &self.end_effectors {
            let [name, link, group] = [&e.name, &e.parent_link, &e.group].map(|text| escaped(text));
            write!(out, "  <end_effector name=\"{name}\" parent_link=\"{link}\" group=\"{group}\"")?;
            if let Some(group) = &e.parent_group {
                write!(out, " parent_group=\"{}\"", escaped(group))?;
            }
            writeln!(out, "/>")?;
        }
        for v in &self.virtual_joints {
            let [name, kind, frame, link] =
                [&v.name, &v.kind, &v.parent_frame, &v.child_link].map(|text| escaped(text));
            writeln!(
                out,
                "  <virtual_joint name=\"{name}\" type=\"{kind}\" parent_frame=\"{frame}\" child_link=\"{link}\"/>"
            )?;
        }
        for name in &self.passive_joints {
            writeln!(out, "  <passive_joint name=\"{}\"/>", escaped(name))?;
        }
        for pair in &self.disabled {
            let [link1, link2, reason] = [&pair.link1, &pair.link2, &pair.reason].map(|text| escaped(text));
            writeln!(out, "  <disable_collisions link1=\"{link1}\" link2=\"{link2}\" reason=\"{reason}\"/>")?;
        }
        for comment in comments {
            // Two hyphens would end the comment.
            writeln!(out, "  <!-- {} -->", comment.replace("--", "- -"))?;
        }
        writeln!(out, "</robot>")
    }
}
