//! Integration tests of `elbowroom-proximity` in one program: a module per subject, whose first line says what belongs there.

mod bvh_bound;
mod ccd;
mod coal;
mod common;
mod contact;
mod continuous_witness;
mod degenerate;
mod golden;
mod local_minima;
mod mesh_groups;
mod mesh_pairs;
mod motion_culling;
mod near_contact;
mod properties;
mod ray_cast;
mod real_links;
mod seams;
mod separation;
mod shapes;
mod slivers;
mod triangle_contacts;
mod upper_bound;
mod weld;
