//! Messages: each is declared once, and its bytes, its schema and its hash come from that declaration.

use crate::cdr::{CdrError, Reader, Writer};
use crate::description::{ElementType, FieldType, Multiplicity, TypeSet};

/// A type that can be a field of a message.
pub trait Field: Sized + Default {
    /// Least number of bytes of an encoded value; bounds the claimed length of a sequence.
    const LEAST_BYTES: usize;

    /// Its type.
    fn field_type() -> FieldType;

    /// Adds the messages in it to a set of descriptions.
    fn describe(_types: &mut TypeSet) {}

    /// Appends the value.
    fn write(&self, to: &mut Writer<'_>);

    /// Reads the next value.
    ///
    /// # Errors
    /// [`CdrError`] if the bytes are not such a value.
    fn read(from: &mut Reader<'_>) -> Result<Self, CdrError>;
}

/// A message of ROS 2.
///
/// ```
/// use elbowroom_ros2::Message;
/// use elbowroom_ros2::msgs::control_msgs::SpeedScalingFactor;
/// let message = SpeedScalingFactor { factor: 0.5 };
/// let bytes = message.encode();
/// assert_eq!(bytes, [0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0xe0, 0x3f]);
/// assert_eq!(SpeedScalingFactor::decode(&bytes)?, message);
/// # Ok::<(), elbowroom_ros2::CdrError>(())
/// ```
pub trait Message: Field {
    /// Its full name, such as `sensor_msgs/msg/JointState`.
    const NAME: &'static str;

    /// Encodes the payload.
    fn encode(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        self.encode_into(&mut bytes);
        bytes
    }

    /// Replaces the contents of a buffer by the payload; does not allocate if the buffer is large enough.
    fn encode_into(&self, bytes: &mut Vec<u8>) {
        bytes.clear();
        self.write(&mut Writer::new(bytes));
    }

    /// Decodes the message of a payload.
    ///
    /// # Errors
    /// [`CdrError`] if the payload is not exactly one such message.
    fn decode(payload: &[u8]) -> Result<Self, CdrError> {
        let mut reader = Reader::new(payload)?;
        let message = Self::read(&mut reader)?;
        reader.end()?;
        Ok(message)
    }

    /// Decodes the message at the beginning of a payload: for types to which later releases append fields.
    ///
    /// # Errors
    /// As for [`Message::decode`], but bytes may follow.
    fn decode_prefix(payload: &[u8]) -> Result<Self, CdrError> {
        Self::read(&mut Reader::new(payload)?)
    }

    /// Its description, with the descriptions of the messages in it.
    fn types() -> TypeSet {
        let mut types = TypeSet::default();
        Self::describe(&mut types);
        types
    }

    /// Its schema in recordings (`ros2msg`).
    fn schema() -> String {
        Self::types().schema(Self::NAME)
    }

    /// Its hash: `RIHS01_` and 64 hexadecimal digits.
    fn type_hash() -> String {
        Self::types().hash(Self::NAME)
    }
}

macro_rules! number {
    ($rust:ty, $id:literal, $name:literal) => {
        impl Field for $rust {
            const LEAST_BYTES: usize = size_of::<$rust>();

            fn field_type() -> FieldType {
                FieldType::one(ElementType::Primitive { id: $id, name: $name })
            }

            fn write(&self, to: &mut Writer<'_>) {
                to.number(self.to_le_bytes());
            }

            fn read(from: &mut Reader<'_>) -> Result<Self, CdrError> {
                from.number().map(<$rust>::from_le_bytes)
            }
        }
    };
}

number!(u8, 3, "uint8");
number!(i32, 6, "int32");
number!(u32, 7, "uint32");
number!(u64, 9, "uint64");
number!(f32, 10, "float32");
number!(f64, 11, "float64");

/// The type `byte`, whose hash differs from that of `uint8`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Byte(pub u8);

impl Field for Byte {
    const LEAST_BYTES: usize = 1;

    fn field_type() -> FieldType {
        FieldType::one(ElementType::Primitive { id: 16, name: "byte" })
    }

    fn write(&self, to: &mut Writer<'_>) {
        to.bytes(&[self.0]);
    }

    fn read(from: &mut Reader<'_>) -> Result<Self, CdrError> {
        from.number().map(|[byte]| Self(byte))
    }
}

impl Field for bool {
    const LEAST_BYTES: usize = 1;

    fn field_type() -> FieldType {
        FieldType::one(ElementType::Primitive { id: 15, name: "bool" })
    }

    fn write(&self, to: &mut Writer<'_>) {
        to.bytes(&[u8::from(*self)]);
    }

    fn read(from: &mut Reader<'_>) -> Result<Self, CdrError> {
        let at = from.at();
        match from.number()? {
            [0] => Ok(false),
            [1] => Ok(true),
            [value] => Err(CdrError::Bool { at, value }),
        }
    }
}

impl Field for String {
    const LEAST_BYTES: usize = 4;

    fn field_type() -> FieldType {
        FieldType::one(ElementType::Primitive { id: 17, name: "string" })
    }

    fn write(&self, to: &mut Writer<'_>) {
        to.text(self);
    }

    fn read(from: &mut Reader<'_>) -> Result<Self, CdrError> {
        from.text().map(str::to_owned)
    }
}

impl<T: Field> Field for Vec<T> {
    const LEAST_BYTES: usize = 4;

    fn field_type() -> FieldType {
        FieldType { multiplicity: Multiplicity::Sequence, ..T::field_type() }
    }

    fn describe(types: &mut TypeSet) {
        T::describe(types);
    }

    fn write(&self, to: &mut Writer<'_>) {
        let count = to.count(self.len());
        self[..count].iter().for_each(|value| value.write(to));
    }

    fn read(from: &mut Reader<'_>) -> Result<Self, CdrError> {
        let count = from.count(T::LEAST_BYTES)?;
        let mut values = Vec::with_capacity(count);
        for _ in 0..count {
            values.push(T::read(from)?);
        }
        Ok(values)
    }
}

impl<T: Field + Copy, const N: usize> Field for [T; N]
where
    [T; N]: Default,
{
    const LEAST_BYTES: usize = N * T::LEAST_BYTES;

    fn field_type() -> FieldType {
        FieldType { multiplicity: Multiplicity::Array(N), ..T::field_type() }
    }

    fn describe(types: &mut TypeSet) {
        T::describe(types);
    }

    fn write(&self, to: &mut Writer<'_>) {
        for value in self {
            value.write(to);
        }
    }

    fn read(from: &mut Reader<'_>) -> Result<Self, CdrError> {
        let mut values = [T::default(); N];
        for value in &mut values {
            *value = T::read(from)?;
        }
        Ok(values)
    }
}

/// Declares a message: a struct with its fields in the order of the `.msg` file.
macro_rules! message {
    ($(#[$about:meta])* $name:ident = $ros:literal { $($(#[$what:meta])* $field:ident: $kind:ty,)* }) => {
        $(#[$about])*
        #[derive(Debug, Clone, Default, PartialEq)]
        pub struct $name {
            $($(#[$what])* pub $field: $kind,)*
        }

        impl $crate::message::Field for $name {
            const LEAST_BYTES: usize = 0 $(+ <$kind as $crate::message::Field>::LEAST_BYTES)*;

            fn field_type() -> $crate::description::FieldType {
                $crate::description::FieldType::one($crate::description::ElementType::Message($ros))
            }

            fn describe(types: &mut $crate::description::TypeSet) {
                let fields = [$((stringify!($field), <$kind as $crate::message::Field>::field_type()),)*];
                if types.add($ros, &fields) {
                    $(<$kind as $crate::message::Field>::describe(types);)*
                }
            }

            fn write(&self, to: &mut $crate::cdr::Writer<'_>) {
                $($crate::message::Field::write(&self.$field, to);)*
            }

            fn read(from: &mut $crate::cdr::Reader<'_>) -> Result<Self, $crate::cdr::CdrError> {
                // The fields of an expression are evaluated in the order in which they are written.
                Ok(Self { $($field: $crate::message::Field::read(from)?,)* })
            }
        }

        impl $crate::message::Message for $name {
            const NAME: &'static str = $ros;
        }
    };
}

pub(crate) use message;
