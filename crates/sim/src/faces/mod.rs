//! What of bodies and cracks is carried along to be shown: rings and crack faces.

pub(crate) mod crack_frame;
pub(crate) mod outlines;
