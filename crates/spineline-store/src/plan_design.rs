//! The design of a plan of blinded readings, and a plan that can be changed.

use serde::Serialize;
use utoipa::ToSchema;

use crate::names::Name;

/// Number, interval and order of readings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
pub struct PlanDesign {
    /// Readings per film and observer.
    pub repeats: u32,
    /// Days of 24 hours between two readings of a film by one observer.
    pub washout_days: u32,
    /// Whether readers see vertebrae that the program proposes, and may accept them. Readers who accept share its model, so
    /// they agree better than readers who click.
    pub proposals: bool,
}

/// A plan without readings yet: it can be changed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
#[schema(as = OpenPlanView)]
pub struct OpenPlan {
    /// Its number, which a change of the plan has to name.
    #[serde(rename = "plan")]
    pub id: i64,
    /// Its observers.
    #[schema(value_type = Vec<String>)]
    pub observers: Vec<Name>,
    /// Number, interval and order of its readings.
    #[serde(flatten)]
    pub design: PlanDesign,
}
