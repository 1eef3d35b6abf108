//! Why kernels could not be written.

/// Why kernels could not be written with lanes.
#[derive(Debug, thiserror::Error)]
pub enum VectorizeError {
    #[error("the kernels are no WGSL:\n{reason}")]
    Parse { reason: String },
    #[error("the kernels are no valid WGSL:\n{reason}")]
    Validate { reason: String },
    #[error("the kernels have no function `{name}`")]
    MissingFunction { name: String },
    #[error("function `{function}` uses {what}, which has no form with lanes yet")]
    Unsupported { function: String, what: String },
}
