//! Parameters → sun, sky and clouds.
