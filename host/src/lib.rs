//! The renderer on top of `ocellus-kernel`: loads OBJ and TOML scenes, renders in parallel, writes pictures.
//!
//! A picture's way: [`load`] reads files into a [`description::SceneDescription`]; [`assemble`] makes the kernel's
//! slices of it, in the precision chosen; [`kernels`] picks the smallest kernel that covers it; [`render`] runs it on
//! all threads into a [`film::Film`]; [`output`] writes pictures. [`commands`] is the program's face.

pub mod accuracy;
mod aims;
pub mod assemble;
pub mod audit;
pub mod cli;
pub mod commands;
pub mod demand;
pub mod description;
pub mod diff;
pub mod error;
mod fields;
pub mod film;
pub mod hierarchy;
pub mod input;
pub mod interrupt;
pub mod isa;
pub mod kernels;
pub mod ledger;
pub mod load;
pub mod output;
pub mod picture;
pub mod progress;
pub mod promise;
pub mod render;
pub mod until;

/// The examples of the README are tests.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
pub struct ReadmeExamples;
