//! No acne, no leaks, no surprises.
