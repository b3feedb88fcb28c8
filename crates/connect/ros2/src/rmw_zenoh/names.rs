//! Names that ROS 2 accepts.

/// Converts a name to a valid name of a node or of a part of a topic: letters, digits and underscores, no digit first.
///
/// Everything else becomes an underscore.
///
/// ```
/// use elbowroom_ros2::rmw_zenoh::ros_name;
/// assert_eq!(ros_name("2nd arm"), "_2nd_arm");
/// assert_eq!(ros_name("ns16"), "ns16");
/// ```
pub fn ros_name(name: &str) -> String {
    let plain: String = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    match plain.chars().next() {
        Some(first) if !first.is_ascii_digit() => plain,
        _ => format!("_{plain}"),
    }
}

/// Converts `std_msgs/msg/String` to its name in DDS: `std_msgs::msg::dds_::String_`.
pub fn type_in_dds(name: &str) -> String {
    match name.rsplit_once('/') {
        Some((package, message)) => format!("{}::dds_::{message}_", package.replace('/', "::")),
        None => format!("{name}_"),
    }
}
