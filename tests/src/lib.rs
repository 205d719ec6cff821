//! What crosses rooms is tested in `tests/`; this library holds what those tests share.
