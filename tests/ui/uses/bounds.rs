//! Bounds that a mechanism does not satisfy report the option that would satisfy them.

use linkwork::prelude::*;

#[mechanism]
struct Cart {
    #[body(mass = 1)]
    cart: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
}

fn in_lanes<M, const NQ: usize, const NV: usize, const NU: usize>(_: &M)
where
    M: Batch<NQ, NV, NU>,
{
}

fn closed<M, const NQ: usize, const NV: usize, const NU: usize, const NH: usize, const NC: usize>(_: &M)
where
    M: Constrained<NQ, NV, NU, NH, NC>,
{
}

fn main() {
    in_lanes(&Cart);
    closed(&Cart);
}
