//! A developer's chores: the whole check (`cargo xtask test`), set-up of the programs it needs (`setup`), and the
//! picture in the README (`pictures`). Runs other programs and reports; knows nothing of landscapes.
#![allow(missing_docs)]
