//! Functions of mechanisms with declared generalized speeds: conversion between these and the joint
//! velocities.

use super::facts::FunctionNeed;
use super::row::{Declaration, GeneratedId, Row};
use super::shape::Argument::{A, Q, V};
use super::shape::Shape;
use crate::syntax::RequestOption;

const SPEEDS: &[FunctionNeed] = &[FunctionNeed::Speeds];

/// Rows of the conversions between generalized speeds and joint velocities.
pub const ROWS: &[Row] = &[
    Row::derived_row(GeneratedId::RatesOfSpeeds, "rates_of_speeds", SPEEDS, |f| Declaration {
        arguments: vec![Q, V],
        timeless: true,
        shape: Shape::Vector(f.nv),
        docs: vec![
            "The joint velocities `Z(q) v` for the generalized speeds `v`: rates of the coordinates, \
             body-frame velocities of ball and free joints, in m/s and rad/s. Entries that no generalized \
             speed replaces are those of `v`.",
            "Not finite in singular configurations, in which the generalized speeds do not determine the \
             joint velocities.",
        ],
    }),
    Row::derived_row(GeneratedId::SpeedsOfRates, "speeds_of_rates", SPEEDS, |f| Declaration {
        arguments: vec![Q, V],
        timeless: true,
        shape: Shape::Vector(f.nv),
        docs: vec![
            "The generalized speeds `Y(q) v` of a motion with the joint velocities `v`: the inverse of \
             [`rates_of_speeds`](Self::rates_of_speeds).",
        ],
    }),
    Row::derived_row(GeneratedId::RateMatrix, "__rate_matrix", SPEEDS, |f| Declaration {
        arguments: vec![Q],
        timeless: true,
        shape: Shape::Square(f.nv),
        ..Declaration::default()
    })
    .without_batched_variant(),
    Row::derived_row(GeneratedId::SpeedMatrix, "__speed_matrix", SPEEDS, |f| Declaration {
        arguments: vec![Q],
        timeless: true,
        shape: Shape::Square(f.nv),
        ..Declaration::default()
    })
    .without_batched_variant(),
    Row::derived_row(GeneratedId::RateChanges, "__rate_changes", SPEEDS, |f| Declaration {
        arguments: vec![Q, V],
        timeless: true,
        shape: Shape::Square(f.nv),
        ..Declaration::default()
    })
    .without_batched_variant(),
    Row::derived_row(GeneratedId::RateAccelerations, "__rate_accelerations", SPEEDS, |f| Declaration {
        arguments: vec![Q, V, A],
        timeless: true,
        shape: Shape::Vector(f.nv),
        ..Declaration::default()
    })
    .without_batched_variant(),
];

/// Rows of the functions of the option `derivatives` for mechanisms with generalized speeds.
pub const DERIVATIVES: &[Row] = &[Row::derived_row(
    GeneratedId::Turning,
    "__turning",
    &[FunctionNeed::Inertia, FunctionNeed::Asks(RequestOption::Derivatives), FunctionNeed::Speeds],
    |f| Declaration {
        arguments: vec![Q, V],
        timeless: true,
        shape: Shape::Square(f.nv),
        ..Declaration::default()
    },
)
.without_batched_variant()];
