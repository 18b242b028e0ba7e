//! Errors that a store must give.

/// Asserts that the store refuses this call with this error.
macro_rules! refused {
    ($call:expr, $($error:tt)+) => {{
        let found = $call;
        let expected = matches!(found, Err(spineline_store::StoreError::$($error)+));
        assert!(expected, "{}: {found:?}", stringify!($call));
    }};
}
