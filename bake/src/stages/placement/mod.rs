//! Landform and templates → where the trees stand.
