//! Landform → adaptive mesh, and the data of the terrain's levels of detail.
