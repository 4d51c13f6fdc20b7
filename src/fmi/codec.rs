//! Values as bytes and back.
//!
//! A value says once which fields it has and in which order, by walking a [`Codec`] through them:
//! one that writes takes each field as it is, one that reads replaces it. So what is written and
//! what is read cannot differ. All numbers are little-endian.

/// What a walk fails with where a field cannot be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unreadable;

/// Takes bytes away or brings them.
pub trait Codec {
    /// Writes `bytes`, or ignores them and reads as many.
    ///
    /// # Errors
    ///
    /// As all that follow: there is nothing to read, or nothing that could be such a value.
    fn bytes<const N: usize>(&mut self, bytes: [u8; N]) -> Result<[u8; N], Unreadable>;

    /// A number that has to be finite.
    fn finite(&mut self, value: &mut f64) -> Result<(), Unreadable> {
        self.real(value)?;
        if value.is_finite() {
            Ok(())
        } else {
            Err(Unreadable)
        }
    }

    /// Any number.
    fn real(&mut self, value: &mut f64) -> Result<(), Unreadable> {
        *value = f64::from_le_bytes(self.bytes(value.to_le_bytes())?);
        Ok(())
    }

    /// A whole number.
    fn signed(&mut self, value: &mut i32) -> Result<(), Unreadable> {
        *value = i32::from_le_bytes(self.bytes(value.to_le_bytes())?);
        Ok(())
    }

    /// A number of things.
    fn count(&mut self, value: &mut u32) -> Result<(), Unreadable> {
        *value = u32::from_le_bytes(self.bytes(value.to_le_bytes())?);
        Ok(())
    }

    /// An index or a length.
    fn place(&mut self, value: &mut usize) -> Result<(), Unreadable> {
        let bytes = self.bytes((*value as u64).to_le_bytes())?;
        *value = usize::try_from(u64::from_le_bytes(bytes)).map_err(|_| Unreadable)?;
        Ok(())
    }

    /// The length of a list of at most `most` items, which gets that length; what is added is
    /// `room`.
    fn resize<T>(
        &mut self,
        list: &mut Vec<T>,
        most: usize,
        room: impl FnMut() -> T,
    ) -> Result<(), Unreadable> {
        let mut length = list.len();
        self.place(&mut length)?;
        if length > most {
            return Err(Unreadable);
        }
        list.resize_with(length, room);
        Ok(())
    }

    /// Yes or no.
    fn flag(&mut self, value: &mut bool) -> Result<(), Unreadable> {
        self.one_of(value, &[false, true])
    }

    /// One of a few values, by its place among `all`.
    fn one_of<T: Copy + PartialEq>(&mut self, value: &mut T, all: &[T]) -> Result<(), Unreadable> {
        let place = all.iter().position(|item| item == value);
        let place = place.and_then(|place| u8::try_from(place).ok());
        let [place] = self.bytes([place.ok_or(Unreadable)?])?;
        *value = *all.get(usize::from(place)).ok_or(Unreadable)?;
        Ok(())
    }

    /// A value that may be missing; `room` is any value of its type. It takes as many bytes
    /// either way.
    fn option<T>(
        &mut self,
        value: &mut Option<T>,
        room: T,
        walk: impl FnOnce(&mut Self, &mut T) -> Result<(), Unreadable>,
    ) -> Result<(), Unreadable> {
        let mut there = value.is_some();
        self.flag(&mut there)?;
        let mut content = value.take().unwrap_or(room);
        walk(self, &mut content)?;
        *value = there.then_some(content);
        Ok(())
    }
}

/// Writes to the end of a vector; never fails.
pub(super) struct Writer<'a>(pub(super) &'a mut Vec<u8>);

impl Codec for Writer<'_> {
    fn bytes<const N: usize>(&mut self, bytes: [u8; N]) -> Result<[u8; N], Unreadable> {
        self.0.extend_from_slice(&bytes);
        Ok(bytes)
    }

    /// What is written is as it is; reading it back is where it is judged.
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
