//! Order conditions of both methods, one per rooted tree.

use nalgebra::{DMatrix, DVector};

use super::dormand_prince::tableau as explicit;
use super::rosenbrock::tableau as stiff;

/// A rooted tree as its subtrees.
#[derive(Clone)]
struct Tree(Vec<Tree>);

impl Tree {
    /// Returns all trees with this number of vertices, each as often as its subtrees can be put in
    /// a row with sizes that do not grow.
    fn all(vertices: usize) -> Vec<Self> {
        forests(vertices - 1, vertices - 1)
            .into_iter()
            .map(Self)
            .collect()
    }

    fn vertices(&self) -> usize {
        1 + self.0.iter().map(Self::vertices).sum::<usize>()
    }

    /// Density γ of the tree (Hairer, Nørsett, Wanner I, section II.2).
    fn density(&self) -> f64 {
        let subtrees = self.0.iter().map(Self::density);
        self.vertices() as f64 * subtrees.product::<f64>()
    }

    /// Returns the elementary weight of each stage. A vertex with one subtree takes `beta`, with
    /// several `alpha`: these differ for a Rosenbrock method (Hairer, Wanner II, section IV.7).
    fn weights(&self, alpha: &DMatrix<f64>, beta: &DMatrix<f64>) -> DVector<f64> {
        let matrix = if self.0.len() == 1 { beta } else { alpha };
        let ones = DVector::from_element(alpha.nrows(), 1.0);
        self.0.iter().fold(ones, |product, subtree| {
            product.component_mul(&(matrix * subtree.weights(alpha, beta)))
        })
    }
}

/// Returns all rows of trees with a total of `vertices`, none larger than `largest`.
fn forests(vertices: usize, largest: usize) -> Vec<Vec<Tree>> {
    if vertices == 0 {
        return vec![Vec::new()];
    }
    let mut all = Vec::new();
    for first in 1..=largest.min(vertices) {
        for tree in Tree::all(first) {
            for mut forest in forests(vertices - first, first) {
                forest.insert(0, tree.clone());
                all.push(forest);
            }
        }
    }
    all
}

/// Returns the largest defect of the conditions of one order.
fn defect(order: usize, b: &DVector<f64>, alpha: &DMatrix<f64>, beta: &DMatrix<f64>) -> f64 {
    let defects = Tree::all(order)
        .into_iter()
        .map(|tree| (b.dot(&tree.weights(alpha, beta)) - 1.0 / tree.density()).abs());
    defects.fold(0.0, f64::max)
}

fn vector(terms: explicit::Terms, length: usize) -> DVector<f64> {
    let mut vector = DVector::zeros(length);
    for &(stage, factor) in terms {
        vector[stage] = factor;
    }
    vector
}

fn explicit_matrix() -> DMatrix<f64> {
    let rows = explicit::A.map(|terms| vector(terms, explicit::STAGES).transpose());
    DMatrix::from_rows(&rows)
}

#[test]
fn the_explicit_method_has_order_8() {
    let a = explicit_matrix();
    let b = a.row(explicit::END).transpose();
    for order in 1..=8 {
        assert!(defect(order, &b, &a, &a) < 1e-14, "order {order}");
    }
    assert!(defect(9, &b, &a, &a) > 1e-9);
    let nodes = a.column_sum() - DVector::from_column_slice(&explicit::C);
    // Coefficients of size 40 cancel.
    assert!(nodes.amax() < 1e-14);
}

#[test]
fn the_explicit_errors_have_their_orders() {
    let a = explicit_matrix();
    let b = a.row(explicit::END).transpose();
    for (error, order) in [(explicit::ERROR_5, 5), (explicit::ERROR_3, 3)] {
        let embedded = &b - vector(error, explicit::STAGES);
        assert!((1..=order).all(|order| defect(order, &embedded, &a, &a) < 1e-14));
        assert!(defect(order + 1, &embedded, &a, &a) > 1e-5);
    }
}

/// Coefficients of a Rosenbrock method in their first form (Hairer, Wanner II, Definition IV.7.1).
struct FirstForm {
    /// Coefficients α.
    alpha: DMatrix<f64>,
    /// Coefficients γ.
    gamma: DMatrix<f64>,
    /// Weights b of orders 5 and 4.
    b: [DVector<f64>; 2],
}

fn first_form() -> FirstForm {
    const N: usize = stiff::STAGES;
    let c = DMatrix::from_fn(N, N, |row, col| {
        stiff::C[row].get(col).copied().unwrap_or(0.0)
    });
    let inverse = DMatrix::identity(N, N) / stiff::GAMMA - c;
    let gamma = inverse.try_inverse().unwrap();
    // Row `N` is the solution.
    let a = DMatrix::from_fn(N + 1, N, |row, col| {
        let last = stiff::A[row.min(stiff::A.len() - 1)];
        let added = f64::from(col >= stiff::A.len() - 1 && col < row);
        last.get(col).copied().unwrap_or(added)
    });
    let weights = |row: usize| (a.row(row) * &gamma).transpose();
    FirstForm {
        alpha: a.rows(0, N) * &gamma,
        b: [weights(N), weights(N - 1)],
        gamma,
    }
}

#[test]
fn the_stiff_method_has_order_5_and_its_error_order_4() {
    let FirstForm { alpha, gamma, b } = first_form();
    let beta = &alpha + &gamma;
    for (b, order) in b.iter().zip([5, 4]) {
        for order in 1..=order {
            assert!(defect(order, b, &alpha, &beta) < 1e-13, "order {order}");
        }
        assert!(defect(order + 1, b, &alpha, &beta) > 1e-6);
    }
    let nodes = alpha.column_sum() - DVector::from_column_slice(&stiff::ALPHA);
    let rates = gamma.column_sum() - DVector::from_column_slice(&stiff::GAMMA_T);
    assert!(nodes.amax() < 1e-13 && rates.amax() < 1e-13);
}
