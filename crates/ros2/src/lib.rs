//! Messages, keys and byte layout of ROS 2 over Zenoh, without input or output.
