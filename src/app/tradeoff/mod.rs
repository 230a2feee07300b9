//! `umbrage tradeoff`: what each approximation of the foliage bake costs and how far it is from the
//! truth, measured on real models.

pub mod truth;
