//! Mechanisms into which a user's macro substitutes types.

macro_rules! cart {
    ($number:ty, $body:path, $joint:ty) => {
        #[linkwork::mechanism]
        struct Cart {
            mass: $number,
            #[body(mass = mass)]
            cart: $body,
            #[joint(ground -> cart, along = x)]
            rail: $joint,
        }
    };
}
cart!(f64, Body, Sleeve);

#[test]
fn macro_fragments_are_accepted_in_attributes() {
    use linkwork::nalgebra::SVector;
    let cart = Cart { mass: 2.0 };
    assert_eq!(cart.mass_matrix(&SVector::zeros())[0], 2.0);
}
