//! Checks that the prelude does not conflict with a program's own items of the same names, with names
//! imported one by one, or with a glob import of nalgebra.

mod both {
    use linkwork::nalgebra::*;
    use linkwork::prelude::*;
    use std::error::Error;
    use std::fmt::Result;

    #[mechanism]
    pub struct Cart {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
        #[point(on = cart, at = y)]
        mast: Point,
        #[output(r(mast / ground))]
        place: Vector,
        #[output(dot(r(mast / ground), ground.x))]
        along: Scalar,
    }

    fn sum_of_entries<T: Scalar + Real>(v: Vector<T, U3, ArrayStorage<T, 3, 1>>) -> T {
        v.sum()
    }

    pub fn use_prelude_beside_nalgebra() -> std::result::Result<f64, Box<dyn Error>> {
        let end = simulate(&Cart).from([0.0], [1.0]).duration(2.0).finish()?;
        let place: Point<f64, 3> = Cart.place(&end.q).into();
        let _: Result = Ok(());
        Ok(sum_of_entries(place.coords) + Cart.along(&end.q) + distance(&place, &Point3::origin()))
    }
}

mod own {
    use linkwork::prelude::*;

    pub struct Error;
    pub struct Sample;
    pub struct Body;
    pub struct Result;
    pub struct Option;
    pub struct Lanes;
    pub trait Mechanism {}
    pub trait Real {}
    impl<T> Mechanism for T {}
    impl<T> Real for T {}
    pub fn at() {}
    pub fn simulate() {}
    pub fn frame() {}
    macro_rules! frame {
        () => {
            1
        };
    }

    #[mechanism(derivatives, batch)]
    pub struct Cart {
        pub m: f64,
        #[body(mass = m)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }

    impl Cart {
        pub fn prepare(&self) -> Sample {
            Sample
        }
    }

    /// Requires the argument to implement the local traits of this module, which have the names of traits in
    /// the prelude.
    fn require_local_traits(_: impl Mechanism + Real) {}

    pub fn use_prelude_beside_own_items() -> usize {
        at();
        require_local_traits(());
        simulate();
        frame();
        let _ = (Error, Sample, Body, Result, Option, Lanes, Cart { m: 1.0 }.prepare());
        frame!()
    }
}

/// Stand-in for a crate that re-exports the library under another name.
pub mod other {
    pub use linkwork as mechanisms;
}

mod far {
    use super::other::mechanisms::prelude::*;

    macro_rules! cart {
        ($name:ident, $mass:literal) => {
            #[mechanism(crate = $crate::own_names::other::mechanisms)]
            pub struct $name {
                #[body(mass = $mass)]
                cart: Body,
                #[joint(ground -> cart, along = x)]
                rail: Sleeve,
            }
        };
    }
    cart!(Light, 1);
    cart!(Heavy, 2);

    pub fn use_prelude_of_renamed_crate() -> f64 {
        #[mechanism(prepare, crate = crate::own_names::other::mechanisms)]
        struct Local<T> {
            m: T,
            #[body(mass = m)]
            cart: Body,
            #[joint(ground -> cart, along = x)]
            rail: Sleeve,
        }
        let (q, local) = ([0.0].into(), Local { m: 3.0 });
        let place = local.frame_placement(frame!(Local<f64>, "cart"), &q);
        let prepared = local.prepare();
        place.translation.x + (Light.mass_matrix(&q) + Heavy.mass_matrix(&q) + prepared.mass_matrix(&q))[0]
    }
}

#[test]
fn user_items_are_not_shadowed_by_generated_names() {
    assert!((both::use_prelude_beside_nalgebra().unwrap() - 5.0 - 5_f64.sqrt()).abs() < 1e-9);
    assert_eq!(own::use_prelude_beside_own_items(), 1);
    assert_eq!(far::use_prelude_of_renamed_crate(), 6.0);
}
