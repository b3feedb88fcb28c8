//! A chain as frames with a centre and a rotation about a vector: the form of virtual-reality models.
//!
//! Source: Reichenbach and Kovačić 2003, eqs. 1-4. Frame k has a fixed centre vector `p_center,k` and a fixed
//! rotation by `θk` about the vector `p_rotation,k`. A dynamic frame i also moves by a translation `c_i` and the
//! angles `γ`, `β`, `α` about x, y and the actual z axis (roll, pitch, yaw):
//!
//! ```text
//! T_center,k   = T(p_center,k)                        (1)
//! T_rotation,k = R(p_rotation,k, θk)                  (2)
//! T_q,i        = T(c_i) · Rz(α_i) · Ry(β_i) · Rx(γ_i)  (3), unity for static frames
//! T⁰_n         = Π_k T_center,k · T_rotation,k · T_q,k  (4), k from 1 to n
//! ```
//!
//! A joint determines one of the six numbers of (3). Joints about x, y or z of their frame are kept. For any other
//! axis the frame is rotated so that its z axis is the joint's axis, and the next frame is rotated back.
//!
//! ```
//! use elbowroom_kinematics::frames::{FrameAxis, FrameChain, JointMotion, LocalFrame};
//! use elbowroom_kinematics::{ChainState, JointKind, Limits};
//! use elbowroom_spatial::Vec3;
//!
//! let limits = Limits::symmetric(3.0);
//! let column = LocalFrame {
//!     motion: Some(JointMotion { joint: "a1".into(), kind: JointKind::Revolute, along: FrameAxis::Z, reversed: false, limits }),
//!     ..LocalFrame::fixed("column", Vec3::Z * 0.75)
//! };
//! let hand = LocalFrame { axis: Vec3::Y, angle: 0.5, ..LocalFrame::fixed("hand", Vec3::X * 1.2) };
//! let arm = FrameChain { frames: vec![LocalFrame::fixed("base", Vec3::ZERO), column, hand] };
//!
//! let chain = arm.to_chain("arm")?;
//! let mut state = ChainState::new(&chain);
//! state.q[0] = 0.3;
//! chain.forward(&mut state);
//! let hand_in_base = arm.tip_in_root(|_| 0.3);
//! assert!(hand_in_base.translation.distance(state.link_in_root(chain.tip()).translation) < 1e-12);
//! # Ok::<(), elbowroom_kinematics::ChainError>(())
//! ```

mod convert;
mod frame;

pub use frame::{Displacement, FrameAxis, FrameChain, JointMotion, LocalFrame};
