//! The shared contract as plain checked data.
