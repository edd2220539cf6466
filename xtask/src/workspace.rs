//! The workspace as `cargo metadata` describes it.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Deserialize;

use crate::shell::{cargo_program, output};

/// Name of the package that must build for bare targets.
pub(crate) const KERNEL: &str = "wavelift-kernel";

#[derive(Deserialize)]
pub(crate) struct Workspace {
    pub(crate) packages: Vec<Package>,
}

#[derive(Deserialize)]
pub(crate) struct Package {
    pub(crate) name: String,
    pub(crate) version: String,
    pub(crate) license: Option<String>,
    pub(crate) features: BTreeMap<String, Vec<String>>,
    pub(crate) metadata: Option<Metadata>,
}

#[derive(Deserialize)]
pub(crate) struct Metadata {
    pub(crate) matrix: Option<Matrix>,
}

/// `[package.metadata.matrix]`: where a package must build, and with which features.
#[derive(Clone, Deserialize)]
pub(crate) struct Matrix {
    pub(crate) targets: Vec<String>,
    pub(crate) features: Vec<String>,
    /// More sets of features, each built together.
    #[serde(default)]
    pub(crate) sets: Vec<Vec<String>>,
}

impl Workspace {
    /// The packages of the workspace alone.
    pub(crate) fn members() -> Result<Self, String> {
        Self::read(&["metadata", "--format-version", "1", "--no-deps"])
    }

    /// The packages of the workspace and everything they depend on, for any target.
    /// Fails when `Cargo.lock` does not fit the manifests.
    pub(crate) fn with_dependencies() -> Result<Self, String> {
        Self::read(&["metadata", "--format-version", "1", "--locked"])
    }

    fn read(arguments: &[&str]) -> Result<Self, String> {
        let text = output(&cargo_program(), arguments)?;
        serde_json::from_str(&text).map_err(|error| format!("cargo metadata: {error}"))
    }

    /// The kernel's matrix, or what is missing from its manifest.
    pub(crate) fn kernel_matrix(&self) -> Result<Matrix, String> {
        let kernel = self
            .packages
            .iter()
            .find(|package| package.name == KERNEL)
            .ok_or_else(|| format!("the workspace has no package {KERNEL}"))?;
        let matrix =
            kernel.metadata.as_ref().and_then(|metadata| metadata.matrix.clone()).ok_or_else(|| {
                "kernel/Cargo.toml has no [package.metadata.matrix] with targets = […] and features = […]"
                    .to_owned()
            })?;
        match matrix
            .features
            .iter()
            .chain(matrix.sets.iter().flatten())
            .find(|feature| !kernel.features.contains_key(*feature))
        {
            Some(feature) => Err(format!("kernel/Cargo.toml: the matrix names no such feature: {feature}")),
            None => Ok(matrix),
        }
    }
}

/// The feature sets of a matrix as arguments of cargo: none, each feature alone, each set, all.
pub(crate) fn feature_sets(matrix: &Matrix) -> Vec<Vec<String>> {
    let with = |features: String| vec!["--no-default-features".to_owned(), "--features".to_owned(), features];
    let mut sets = vec![vec!["--no-default-features".to_owned()]];
    sets.extend(matrix.features.iter().cloned().map(with));
    sets.extend(matrix.sets.iter().map(|set| with(set.join(","))));
    sets.push(vec!["--all-features".to_owned()]);
    sets
}

/// Root of the workspace, whatever the folder the command was given in.
pub(crate) fn root() -> PathBuf {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    package.parent().unwrap_or(package).to_path_buf()
}

#[cfg(test)]
mod tests {
    use super::*;

    const METADATA: &str = r#"{ "packages": [ { "name": "wavelift-kernel", "version": "1.0.0",
        "license": "MIT", "features": { "serde": [], "embedded-io": [] },
        "metadata": { "matrix": { "targets": ["t"], "features": ["embedded-io", "serde"], "sets": [["serde", "embedded-io"]] } } } ] }"#;

    #[test]
    fn feature_sets_are_none_each_alone_those_named_and_all() {
        let workspace: Workspace = serde_json::from_str(METADATA).unwrap();
        let sets = feature_sets(&workspace.kernel_matrix().unwrap());
        let expected: [&[&str]; 5] = [
            &["--no-default-features"],
            &["--no-default-features", "--features", "embedded-io"],
            &["--no-default-features", "--features", "serde"],
            &["--no-default-features", "--features", "serde,embedded-io"],
            &["--all-features"],
        ];
        assert_eq!(sets, expected);
    }

    #[test]
    fn a_missing_table_and_an_unknown_feature_are_named() {
        let without = METADATA.replace("matrix", "other");
        let workspace: Workspace = serde_json::from_str(&without).unwrap();
        assert!(workspace.kernel_matrix().err().unwrap().contains("[package.metadata.matrix]"));

        let unknown = METADATA.replace(r#"["embedded-io","#, r#"["defmt","#);
        let workspace: Workspace = serde_json::from_str(&unknown).unwrap();
        assert!(workspace.kernel_matrix().err().unwrap().ends_with("no such feature: defmt"));
    }
}
