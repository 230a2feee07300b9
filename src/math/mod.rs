//! Small mathematics shared by every room: packing, colour, bounds, statistics.
