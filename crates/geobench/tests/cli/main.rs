//! The program as its users meet it.

mod algos;
mod claims;
mod compare;
mod distance;
mod errors;
mod gate;
mod generate;
mod history;
mod info;
mod instructions;
mod isolation;
mod merge;
mod outside;
mod path;
mod points;
mod pool;
mod report;
mod reproduce;
mod resume;
mod run;
mod shell;
mod simd;
mod support;
mod threads;
mod verify;
mod voronoi;
