//! Types of Rust that samples can have.

use super::ElementType;

/// A type of Rust that is one of the ten of samples.
pub trait Sample: bytemuck::Pod + Send + Sync + PartialOrd + sealed::Sealed {
    /// Its name in files.
    const ELEMENT: ElementType;

    /// The nearest number in double precision.
    fn to_f64(self) -> f64;

    /// The value of one that lies in memory as the file has it, little-endian; and back.
    #[must_use]
    fn of_little(value: Self) -> Self;
}

mod sealed {
    pub trait Sealed {}
}

macro_rules! samples {
    ($($type:ident $element:ident $of_little:expr;)*) => {$(
        impl sealed::Sealed for $type {}

        impl Sample for $type {
            const ELEMENT: ElementType = ElementType::$element;

            fn to_f64(self) -> f64 {
                self as f64
            }

            fn of_little(value: Self) -> Self {
                $of_little(value)
            }
        }
    )*};
}

samples! {
    u8 U8 Self::from_le;
    i8 I8 Self::from_le;
    u16 U16 Self::from_le;
    i16 I16 Self::from_le;
    u32 U32 Self::from_le;
    i32 I32 Self::from_le;
    u64 U64 Self::from_le;
    i64 I64 Self::from_le;
    f32 F32 |value: Self| Self::from_bits(u32::from_le(value.to_bits()));
    f64 F64 |value: Self| Self::from_bits(u64::from_le(value.to_bits()));
}

/// Calls `each` with every value that little-endian bytes of a type stand for, in double precision: exact but for
/// integers beyond 2^53.
pub(crate) fn each_f64(element: ElementType, bytes: &[u8], each: &mut dyn FnMut(f64)) {
    fn of<T: Sample>(bytes: &[u8], each: &mut dyn FnMut(f64)) {
        for value in bytes.chunks_exact(size_of::<T>()) {
            each(T::of_little(bytemuck::pod_read_unaligned(value)).to_f64());
        }
    }
    match element {
        ElementType::U8 => of::<u8>(bytes, each),
        ElementType::I8 => of::<i8>(bytes, each),
        ElementType::U16 => of::<u16>(bytes, each),
        ElementType::I16 => of::<i16>(bytes, each),
        ElementType::U32 => of::<u32>(bytes, each),
        ElementType::I32 => of::<i32>(bytes, each),
        ElementType::U64 => of::<u64>(bytes, each),
        ElementType::I64 => of::<i64>(bytes, each),
        ElementType::F32 => of::<f32>(bytes, each),
        ElementType::F64 => of::<f64>(bytes, each),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_of_every_type_are_its_values() {
        for element in ElementType::ALL {
            let bytes: Vec<u8> = match element {
                ElementType::F32 => [-1.5_f32, 2.0].iter().flat_map(|value| value.to_le_bytes()).collect(),
                ElementType::F64 => [-1.5_f64, 2.0].iter().flat_map(|value| value.to_le_bytes()).collect(),
                _ => {
                    let mut bytes = vec![0; 2 * element.bytes()];
                    bytes[..element.bytes()].fill(0xff);
                    bytes[element.bytes()] = 2;
                    bytes
                }
            };
            let first = match element {
                _ if element.is_float() => -1.5,
                _ if element.is_signed_integer() => -1.0,
                _ => 2_f64.powi(8 * element.bytes() as i32) - 1.0,
            };
            let mut values = Vec::new();
            each_f64(element, &bytes, &mut |value| values.push(value));
            // Of 2^64 - 1 the nearest is 2^64.
            assert_eq!(
                values,
                [if element == ElementType::U64 { 2_f64.powi(64) } else { first }, 2.0],
                "{element}"
            );
        }
    }
}
