//! Named values of the library with a schema of the HTTP interface.

use std::borrow::Cow;

use serde::{Deserialize, Serialize};
use spineline::anatomy::{Named, Side};
use spineline::measure::Origin;
use utoipa::openapi::RefOr;
use utoipa::openapi::schema::{ObjectBuilder, Schema, Type};
use utoipa::{PartialSchema, ToSchema};

/// A named value, with a schema.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Wire<T>(pub T);

impl<T: Named> PartialSchema for Wire<T> {
    fn schema() -> RefOr<Schema> {
        let names = T::ALL.iter().map(|value| value.key());
        ObjectBuilder::new()
            .schema_type(Type::String)
            .description(Some(T::description()))
            .enum_values(Some(names))
            .into()
    }
}

impl<T: Named> ToSchema for Wire<T> {
    fn name() -> Cow<'static, str> {
        format!("{}Name", T::TYPE).into()
    }
}

/// The patient's side.
pub type SideName = Wire<Side>;
/// How the place of a corner came about.
pub type OriginName = Wire<Origin>;

#[cfg(test)]
mod tests {
    use super::*;

    /// A side of the patient, never of the picture.
    #[derive(ToSchema)]
    #[schema(rename_all = "snake_case")]
    #[allow(dead_code)]
    enum SideName {
        Left,
        Right,
    }

    #[test]
    fn the_schema_of_a_named_value_equals_that_of_a_derived_enum() {
        let text = |schema: RefOr<Schema>| serde_json::to_string(&schema).expect("a schema");
        assert_eq!(text(Wire::<Side>::schema()), text(SideName::schema()));
        assert_eq!(Wire::<Side>::name(), SideName::name());
    }
}
