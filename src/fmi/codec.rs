//! Values as bytes and back.
//!
//! A value visits its fields with a [`Codec`] in one function: a writing codec copies each field,
//! a reading codec replaces it. The written and the read layout therefore cannot differ. All
//! numbers are little-endian.

/// The bytes end early, or do not encode a permitted value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unreadable;

/// Writes fields to bytes, or reads them from bytes.
pub trait Codec {
    /// Writes `bytes`, or reads as many instead.
    ///
    /// # Errors
    ///
    /// [`Unreadable`], like all methods below.
    fn bytes<const N: usize>(&mut self, bytes: [u8; N]) -> Result<[u8; N], Unreadable>;

    /// Visits a number that must be finite.
    fn finite(&mut self, value: &mut f64) -> Result<(), Unreadable> {
        self.real(value)?;
        if value.is_finite() {
            Ok(())
        } else {
            Err(Unreadable)
        }
    }

    /// Visits any number.
    fn real(&mut self, value: &mut f64) -> Result<(), Unreadable> {
        *value = f64::from_le_bytes(self.bytes(value.to_le_bytes())?);
        Ok(())
    }

    /// Visits a whole number.
    fn signed(&mut self, value: &mut i32) -> Result<(), Unreadable> {
        *value = i32::from_le_bytes(self.bytes(value.to_le_bytes())?);
        Ok(())
    }

    /// Visits a count.
    fn count(&mut self, value: &mut u32) -> Result<(), Unreadable> {
        *value = u32::from_le_bytes(self.bytes(value.to_le_bytes())?);
        Ok(())
    }

    /// Visits 64 bits.
    fn word(&mut self, value: &mut u64) -> Result<(), Unreadable> {
        *value = u64::from_le_bytes(self.bytes(value.to_le_bytes())?);
        Ok(())
    }

    /// Visits an index or a length.
    fn index(&mut self, value: &mut usize) -> Result<(), Unreadable> {
        let bytes = self.bytes((*value as u64).to_le_bytes())?;
        *value = usize::try_from(u64::from_le_bytes(bytes)).map_err(|_| Unreadable)?;
        Ok(())
    }

    /// Visits the length of a list, which may have up to `most` items; a reading codec resizes
    /// the list and adds items made by `item`.
    fn resize<T>(
        &mut self,
        list: &mut Vec<T>,
        most: usize,
        item: impl FnMut() -> T,
    ) -> Result<(), Unreadable> {
        let mut length = list.len();
        self.index(&mut length)?;
        if length > most {
            return Err(Unreadable);
        }
        list.resize_with(length, item);
        Ok(())
    }

    /// Visits a Boolean.
    fn flag(&mut self, value: &mut bool) -> Result<(), Unreadable> {
        self.one_of(value, &[false, true])
    }

    /// Visits each of some values.
    fn each<'a, T: 'a>(
        &mut self,
        values: impl IntoIterator<Item = &'a mut T>,
        mut visit: impl FnMut(&mut Self, &mut T) -> Result<(), Unreadable>,
    ) -> Result<(), Unreadable> {
        let mut values = values.into_iter();
        values.try_for_each(|value| visit(self, value))
    }

    /// Visits one of a few values by its index in `all`.
    fn one_of<T: Copy + PartialEq>(&mut self, value: &mut T, all: &[T]) -> Result<(), Unreadable> {
        let index = all.iter().position(|item| item == value);
        let index = index.and_then(|index| u8::try_from(index).ok());
        let [index] = self.bytes([index.ok_or(Unreadable)?])?;
        *value = *all.get(usize::from(index)).ok_or(Unreadable)?;
        Ok(())
    }

    /// Visits a value that may be missing; `default` is any value of its type. Present or missing,
    /// it takes the same number of bytes.
    fn option<T>(
        &mut self,
        value: &mut Option<T>,
        default: T,
        visit: impl FnOnce(&mut Self, &mut T) -> Result<(), Unreadable>,
    ) -> Result<(), Unreadable> {
        let mut present = value.is_some();
        self.flag(&mut present)?;
        let mut content = value.take().unwrap_or(default);
        visit(self, &mut content)?;
        *value = present.then_some(content);
        Ok(())
    }
}

/// Appends to a vector; never fails.
pub(super) struct Writer<'a>(pub(super) &'a mut Vec<u8>);

impl Codec for Writer<'_> {
    fn bytes<const N: usize>(&mut self, bytes: [u8; N]) -> Result<[u8; N], Unreadable> {
        self.0.extend_from_slice(&bytes);
        Ok(bytes)
    }

    /// Writes any number: the reader checks it.
    fn finite(&mut self, value: &mut f64) -> Result<(), Unreadable> {
        self.real(value)
    }
}

/// Reads from the front of a slice.
pub(super) struct Reader<'a>(pub(super) &'a [u8]);

impl Codec for Reader<'_> {
    fn bytes<const N: usize>(&mut self, _: [u8; N]) -> Result<[u8; N], Unreadable> {
        let (bytes, rest) = self.0.split_first_chunk().ok_or(Unreadable)?;
        self.0 = rest;
        Ok(*bytes)
    }
}
