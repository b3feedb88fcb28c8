//! Synthetic images: an overhead camera's view of prisms on a textured floor, for tests and demonstrations.
//!
//! Painter's algorithm through the same [`Camera`](crate::Camera) that the [`CameraTracker`](crate::CameraTracker) uses:
//! floor, shadows, prisms from far to near, the arm, then illumination and noise. The same seed gives the same image on
//! every machine.

mod canvas;
mod conditions;
mod random;
mod renderer;
mod solid;

pub use conditions::RenderConditions;
pub use renderer::Renderer;
pub use solid::RenderedSolid;
