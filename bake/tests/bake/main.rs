//! Whole bakes, by the program as a person runs it and by the library that it is made of.

mod bad_input;
mod breed;
mod eviction;
mod exit_codes;
mod export;
mod faults;
mod healing;
mod kinds;
mod library;
mod lineage;
mod manual;
mod random_genomes;
mod stage_digests;
mod strangers;
mod watch;
mod whole_bake;
mod world;
