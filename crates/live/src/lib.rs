//! The running service: a monitor per controller, an arbiter, on a network.
