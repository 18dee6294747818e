//! The accuracy of hits: every intersector against brute force, against the others, and against
//! exact integers; rays that leave surfaces and that continue through them.

mod certified;
mod continuation;
mod cross_check;
#[cfg(feature = "measure")]
mod dominated_modes;
mod far_coordinates;
#[cfg(feature = "measure")]
mod oracle;
mod order;
mod random_scenes;
mod ray_ends;
mod scale;
mod self_intersection;
#[cfg(feature = "measure")]
mod stress;
#[cfg(all(feature = "embree", feature = "measure"))]
mod validate;
