//! The techniques against the ray tracer on the built-in scenes, by family. Bounds are values measured on a software
//! adapter, with a small margin; they may be tightened, never loosened. `golden` compares with golden masks.

mod as_published;
mod backprojection;
mod baselines;
mod bitmask;
mod common;
mod edge_cases;
mod enclosed;
mod filterable;
mod golden;
mod grounds;
mod in_space;
mod lights;
mod many_lights;
mod multi_layer;
mod ray_traced;
mod reprojection;
mod roughness;
mod sample_based;
mod sample_sets;
mod shading;
mod soft;
mod texels;
mod translucent;
mod view_samples;
mod wide_lights;
