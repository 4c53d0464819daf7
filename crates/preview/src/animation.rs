//! An animation of pictures of one size.

use crate::origin::TOOL;
use crate::picture::{EncodeError, Picture};
use gif::{Encoder, Extension, Frame, Repeat};

/// Time for which the last picture is shown before the first comes again, in hundredths of a second.
const LAST_DELAY: u16 = 100;
/// Shortest time for which a picture is shown, in hundredths of a second: browsers take less for a mistake, and show it
/// for ten.
const SHORTEST_DELAY: f64 = 2.0;

/// A picture in the colours and the packing of GIF, so that pictures can be packed side by side and take little room
/// until all of them are there.
#[derive(Debug, Clone)]
pub struct EncodedFrame(Frame<'static>);

impl EncodedFrame {
    /// Packs a picture.
    ///
    /// # Errors
    /// When it is too large.
    pub fn new(picture: &Picture) -> Result<Self, EncodeError> {
        let mut frame = picture.indexed("GIF")?;
        frame.make_lzw_pre_encoded();
        Ok(Self(frame))
    }
}

/// Pictures of one size, one after the other, for ever.
#[derive(Debug, Clone, Default)]
pub struct Animation(Vec<EncodedFrame>);

impl Animation {
    /// Of these pictures, in this order.
    pub fn new(frames: Vec<EncodedFrame>) -> Self {
        Self(frames)
    }

    /// The bytes of a GIF file that shows `playback` pictures per second, as near as hundredths of a second come to it,
    /// and at most 50.
    ///
    /// # Errors
    /// When it cannot be encoded.
    pub fn to_gif(mut self, playback: f64) -> Result<Vec<u8>, EncodeError> {
        let delay = (100.0 / playback).round().clamp(SHORTEST_DELAY, f64::from(u16::MAX)) as u16;
        self.0.iter_mut().for_each(|frame| frame.0.delay = delay);
        let Some(last) = self.0.last_mut() else { return Ok(Vec::new()) };
        last.0.delay = delay.max(LAST_DELAY);
        let (width, height) = (last.0.width, last.0.height);
        let mut encoder = Encoder::new(Vec::new(), width, height, &[])?;
        encoder.write_raw_extension(Extension::Comment.into(), &[TOOL.as_bytes()])?;
        encoder.set_repeat(Repeat::Infinite)?;
        for EncodedFrame(frame) in &self.0 {
            encoder.write_lzw_pre_encoded_frame(frame)?;
        }
        Ok(encoder.into_inner()?)
    }
}
