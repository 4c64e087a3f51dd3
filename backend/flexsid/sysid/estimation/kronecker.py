"""Normal equations without a Jacobian: sums over frequencies as products of small matrices.

With J = G_i w_j the normal matrix is N[(i,j),(i',j')] = Re sum_k A_ii' conj(w_j) w_j',
A = G^H W G. The real part of a sum of complex products is one real matrix product of
their interleaved parts, so no complex product is formed; as A and w w^H are
Hermitian, half of each is enough. With a frequency shape each row has variables of its own,
and there is one product for each pair of rows.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from jaxtyping import Complex, Float

from flexsid.sysid.estimation.frequency_domain_model import (
    FactoredModel,
    FrequencyDomainModel,
    Sensitivity,
)
from flexsid.sysid.estimation.linear_algebra import sum_products
from flexsid.sysid.estimation.noise import SpectralMatrix


class NormalForm:
    """Normal matrix and gradient of a line model in Kronecker form."""

    def __init__(self, model: FrequencyDomainModel, factored: FactoredModel | None = None) -> None:
        self.model = model
        self._factored = model if factored is None else factored
        places = self._factored
        n_r, n_w = places.rows.size, places.columns.size
        self._scales = np.outer(places.scale, places.scale)
        # Reserved once: new memory takes as long to obtain as to fill.
        self._weighted = np.empty(places.sensors.shape, dtype=complex)
        self._of_row = [np.flatnonzero(places.pair_rows == row) for row in range(n_r)]
        self._is_shaped = model.factors is not None
        if not self._is_shaped:
            n_w += int(np.count_nonzero(places.pair_columns >= n_w))
            self._upper = _index_upper(n_r)
            pairs = (tuple(places.pair_rows.tolist()), tuple(places.pair_columns.tolist()))
            self._indices = _index_pairs(*pairs, n_r, n_w)
            self._outer = np.empty((n_w * (n_w + 1) // 2, places.s.size), dtype=complex)
            self._blocks = np.empty((2, self._upper.size, places.s.size), dtype=complex)
        self._in_order = bool((places.order[1:] > places.order[:-1]).all())

    def equations(
        self,
        sensitivity: Sensitivity,
        residuals: Complex[np.ndarray, "n_omega n_y"],
        weights: SpectralMatrix,
    ) -> tuple[Float[np.ndarray, "n_theta n_theta"], Float[np.ndarray, " n_theta"]]:
        """Compute Re sum J^H W J and Re sum J^H W nu.

        Parameters
        ----------
        sensitivity
            Factored sensitivities.
        residuals
            Measured less modelled outputs.
        weights
            Inverse noise covariance at each frequency.
        """
        return self.matrix(sensitivity, weights), self._gradient(sensitivity, residuals, weights)

    def gradient(
        self,
        sensitivity: Sensitivity,
        residuals: Complex[np.ndarray, "n_omega n_y"],
        weights: SpectralMatrix,
    ) -> Float[np.ndarray, " n_theta"]:
        """Compute Re sum J^H W nu."""
        weights.times(sensitivity.forces, out=self._weighted)
        np.conjugate(self._weighted, out=self._weighted)
        return self._gradient(sensitivity, residuals, weights)

    def _gradient(
        self,
        sensitivity: Sensitivity,
        residuals: Complex[np.ndarray, "n_omega n_y"],
        weights: SpectralMatrix,
    ) -> Float[np.ndarray, " n_theta"]:
        """Compute Re sum J^H W nu from weighted forces."""
        model, own = self._factored, self._factored.own_outputs
        b = np.matmul(self._weighted.transpose(0, 2, 1), residuals[:, :, None])[:, :, 0]
        pull = _multiply_real(np.ascontiguousarray(b.T), sensitivity.variables)
        g = pull[model.pair_rows, model.pair_columns] * model.scale
        if own.size:
            weighted_residuals = weights.times(residuals[:, :, None])[:, :, 0]
            E = sensitivity.own.conj()
            g = np.append(g, np.real(np.einsum("ek,ke->e", E, weighted_residuals[:, own])))
        if sensitivity.ends is not None:
            pull = weights.times(residuals[:, :, None]).conj()
            g = np.append(g, np.real(np.sum(pull * sensitivity.ends, axis=(0, 1))))
        return g if self._in_order else g[np.argsort(model.order)]

    def cross(
        self,
        sensitivity: Sensitivity,
        columns: Complex[np.ndarray, "n_omega n_y n"],
        weights: SpectralMatrix,
    ) -> Float[np.ndarray, "n_theta n"]:
        """Compute Re sum J^H W X of other columns X."""
        own = self._factored.own_outputs
        weighted = weights.times(sensitivity.forces, out=self._weighted)
        np.conjugate(weighted, out=weighted)
        parts = [self._pull(weighted, columns, sensitivity.variables).T]
        if own.size or sensitivity.ends is not None:
            loads = weights.times(columns)
            E = sensitivity.own.conj()
            parts.append(np.real(np.einsum("ek,kec->ec", E, loads[:, own])))
            if sensitivity.ends is not None:
                parts.append(sum_products(sensitivity.ends, loads))
        return self._order_rows(np.concatenate(parts))

    def _pull(
        self,
        weighted: Complex[np.ndarray, "n_omega n_y n_r"],
        columns: Complex[np.ndarray, "n_omega n_y n"],
        w: Complex[np.ndarray, "n_w n_omega"],
    ) -> Float[np.ndarray, "n n_pairs"]:
        """Compute Re sum X^H W J of the pairs; ``weighted`` is the conjugate of W G."""
        model = self._factored
        loads = np.matmul(weighted.transpose(0, 2, 1), columns).transpose(2, 1, 0)
        cross = _multiply_real(np.ascontiguousarray(loads).reshape(-1, w.shape[1]), w)
        cross = cross.reshape(columns.shape[2], weighted.shape[2], w.shape[0])
        return cross[:, model.pair_rows, model.pair_columns] * model.scale

    def scores(
        self,
        sensitivity: Sensitivity,
        residuals: Complex[np.ndarray, "n_omega n_y"],
        weights: SpectralMatrix,
    ) -> Float[np.ndarray, "n_theta n_omega"]:
        """Compute Re J^H W nu of every frequency."""
        model, own = self._factored, self._factored.own_outputs
        weighted = weights.times(residuals[:, :, None])
        pull = np.matmul(sensitivity.forces.conj().transpose(0, 2, 1), weighted)[:, :, 0]
        w = sensitivity.variables.conj()[model.pair_columns]
        parts = [np.real(pull.T[model.pair_rows] * w) * model.scale[:, None]]
        parts.append(np.real(sensitivity.own.conj() * weighted[:, own, 0].T))
        if sensitivity.ends is not None:
            parts.append(np.real(np.sum(sensitivity.ends.conj() * weighted, axis=1)).T)
        return self._order_rows(np.concatenate(parts))

    def source_scores(
        self,
        sensitivity: Sensitivity,
        source: Complex[np.ndarray, "n_source n_y"],
        weights: SpectralMatrix,
        gain: Complex[np.ndarray, "n_omega n_source"],
    ) -> Float[np.ndarray, "n_theta n_source"]:
        """Compute Re sum_k J_k^H W_k gain_km n_m for the residual n of every source frequency m."""
        model, own = self._factored, self._factored.own_outputs
        pulled = weights.times(sensitivity.forces).conj().transpose(0, 2, 1) @ source.T
        w = sensitivity.variables.conj()
        scores = np.empty((model.order.size, len(source)))
        for row, index in enumerate(self._of_row):
            loads = w[model.pair_columns[index]] * model.scale[index, None]
            scores[index] = np.real(loads @ (gain * pulled[:, row]))
        for k, output in enumerate(own.tolist(), start=model.pair_rows.size):
            unit = np.zeros((*weights.block.shape, source.shape[1], 1), dtype=complex)
            unit[:, output, 0] = sensitivity.own[k - model.pair_rows.size]
            load = weights.times(unit)[:, :, 0].conj() @ source.T
            scores[k] = np.real(np.sum(gain * load, axis=0))
        return self._order_rows(scores)

    def _order_rows(self, values: np.ndarray) -> np.ndarray:
        """Return the rows in the order of theta."""
        return values if self._in_order else values[np.argsort(self._factored.order)]

    def matrix(
        self, sensitivity: Sensitivity, weights: SpectralMatrix
    ) -> Float[np.ndarray, "n_theta n_theta"]:
        """Compute Re sum J^H W J."""
        model = self._factored
        G, w = sensitivity.forces, sensitivity.variables
        weighted = weights.times(G, out=self._weighted)
        np.conjugate(weighted, out=weighted)
        A = np.matmul(weighted.transpose(0, 2, 1), G).reshape(G.shape[0], -1)
        p, own = model.pair_rows.size, model.own_outputs
        N = np.empty((model.order.size,) * 2)
        if self._is_shaped:
            np.multiply(self._sum_by_rows(A.T, w), self._scales, out=N[:p, :p])
        else:
            self._blocks[0] = A.T[self._upper]
            np.conjugate(self._blocks[0], out=self._blocks[1])
            sums = _multiply_real(self._blocks.reshape(-1, w.shape[1]), self._multiply_outer(w))
            np.multiply(sums.ravel()[self._indices], self._scales, out=N[:p, :p])
        if own.size:
            E = sensitivity.own
            cross = np.empty((own.size, p))
            of_outputs = np.ascontiguousarray(weighted.transpose(1, 2, 0))
            for output in np.unique(own).tolist():  # small arrays stay in the cache
                mine = np.flatnonzero(own == output)
                loads = of_outputs[output] * E[mine][:, None, :]
                part = _multiply_real(loads.reshape(-1, w.shape[1]), w)
                part = part.reshape(mine.size, -1, w.shape[0])
                cross[mine] = part[:, model.pair_rows, model.pair_columns]
            last = p + own.size
            np.multiply(cross, model.scale, out=N[p:last, :p])
            N[:p, p:last] = N[p:last, :p].T
            N[p:last, p:last] = _multiply_own(E, own, weights)
        if sensitivity.ends is not None:
            self._append_ends(N, sensitivity, weighted, weights)
        return self._reorder(N)

    def _append_ends(
        self,
        N: Float[np.ndarray, "n_theta n_theta"],
        sensitivity: Sensitivity,
        weighted: Complex[np.ndarray, "n_omega n_y n_r"],
        weights: SpectralMatrix,
    ) -> None:
        """Fill the last rows and columns, of end states; ``weighted`` is the conjugate of W G."""
        ends = sensitivity.ends
        assert ends is not None
        loads = weights.times(ends)
        n_ends, p, own = ends.shape[2], self._factored.pair_rows.size, self._factored.own_outputs
        N[-n_ends:, :p] = self._pull(weighted, ends, sensitivity.variables)
        N[-n_ends:, p:-n_ends] = np.real(
            np.einsum("kec,ek->ce", loads[:, own].conj(), sensitivity.own)
        )
        N[:-n_ends, -n_ends:] = N[-n_ends:, :-n_ends].T
        N[-n_ends:, -n_ends:] = sum_products(ends, loads)

    def _sum_by_rows(
        self, A: Complex[np.ndarray, "n_r2 n_omega"], w: Complex[np.ndarray, "n_w n_omega"]
    ) -> Float[np.ndarray, "n_pairs n_pairs"]:
        """Compute Re sum A_ii' conj(w_j) w_j' of every pair of parameters, row by row."""
        columns = self._factored.pair_columns
        n_r = len(self._of_row)
        sums = np.empty((columns.size, columns.size))
        for i, own in enumerate(self._of_row):
            mine = w[columns[own]]
            for j in range(i, n_r):
                other = self._of_row[j]
                block = _multiply_real(A[i * n_r + j] * w[columns[other]], mine)
                sums[np.ix_(other, own)] = block
                sums[np.ix_(own, other)] = block.T
        return sums

    def output_gradients(
        self,
        sensitivity: Sensitivity,
        residuals: Complex[np.ndarray, "n_omega n_y"],
        weights: SpectralMatrix,
    ) -> Float[np.ndarray, "n_groups n_theta n_y"]:
        """Compute Re sum J^H W nu of every output, by group of frequencies; W diagonal."""
        model = self._factored
        pull = (weights.expand_blocks() * residuals).T
        n_y, n_r = sensitivity.forces.shape[1:]
        loads = np.empty((n_y, n_r, pull.shape[1]), dtype=complex)
        np.conjugate(sensitivity.forces.transpose(1, 2, 0), out=loads)
        loads *= pull[:, None, :]
        n_pairs, own = model.pair_rows.size, model.own_outputs
        parts = np.zeros((weights.blocks.shape[0], self._factored.order.size, n_y))
        for part, lines in zip(parts, weights.block_slices(), strict=True):
            spread = _multiply_real(
                np.ascontiguousarray(loads[:, :, lines]).reshape(n_y * n_r, -1),
                np.ascontiguousarray(sensitivity.variables[:, lines]),
            ).reshape(n_y, n_r, -1)
            picked = spread[:, model.pair_rows, model.pair_columns] * model.scale
            part[model.order[:n_pairs]] = picked.T
            if own.size:
                E = sensitivity.own[:, lines]
                part[model.order[n_pairs : n_pairs + own.size], own] = np.real(
                    np.einsum("ek,ek->e", E.conj(), pull[own][:, lines])
                )
            if sensitivity.ends is not None:
                part[model.order[n_pairs + own.size :]] = np.real(
                    np.einsum("kye,yk->ey", sensitivity.ends[lines].conj(), pull[:, lines])
                )
        return parts

    def matrix_gradients(
        self,
        sensitivity: Sensitivity,
        residuals: Complex[np.ndarray, "n_omega n_y"],
        weights: SpectralMatrix,
    ) -> list[Float[np.ndarray, "n_theta n_pairs"]]:
        """Compute -1/2 d(sum nu nu^H)/dtheta of every group, whitened by W.

        Hermitian matrices, as one row of real numbers for each parameter.
        """
        model, own = self._factored, self._factored.own_outputs
        n_y, n_r = sensitivity.forces.shape[1:]
        n_pairs = model.pair_rows.size
        parts = []
        for matrix, lines in zip(weights.blocks, weights.block_slices(), strict=True):
            whitener = np.linalg.cholesky(matrix).conj().T
            nu = (residuals[lines] @ whitener.T).conj()
            forces = np.matmul(whitener, sensitivity.forces[lines]).reshape(-1, n_y * n_r)
            moved = sensitivity.variables[:, None, lines] * nu.T
            spread = (forces.T @ moved.reshape(-1, nu.shape[0]).T).reshape(n_y, n_r, -1, n_y)
            cross = np.empty((model.order.size, n_y, n_y), dtype=complex)
            picked = spread[:, model.pair_rows, model.pair_columns]
            cross[model.order[:n_pairs]] = picked.transpose(1, 0, 2) * model.scale[:, None, None]
            single = sensitivity.own[:, lines] @ nu
            n_single = n_pairs + own.size
            cross[model.order[n_pairs:n_single]] = (
                whitener[:, own].T[:, :, None] * single[:, None, :]
            )
            if sensitivity.ends is not None:
                whitened = np.matmul(whitener, sensitivity.ends[lines])
                cross[model.order[n_single:]] = np.einsum("kye,kz->eyz", whitened, nu)
            half = 0.5 * (cross + cross.conj().transpose(0, 2, 1))
            parts.append(half.reshape(model.order.size, -1).view(float))
        return parts

    def _multiply_outer(
        self, w: Complex[np.ndarray, "n_w n_omega"]
    ) -> Complex[np.ndarray, "n_pairs n_omega"]:
        """Compute w_j conj(w_j') for j <= j', row by row."""
        conjugate = w.conj()
        first = 0
        for j, variable in enumerate(w):
            last = first + len(w) - j
            np.multiply(variable, conjugate[j:], out=self._outer[first:last])
            first = last
        return self._outer

    def _reorder(
        self, N: Float[np.ndarray, "n_theta n_theta"]
    ) -> Float[np.ndarray, "n_theta n_theta"]:
        if self._in_order:
            return N
        back = np.argsort(self._factored.order)
        return N[np.ix_(back, back)]


def _multiply_real(
    a: Complex[np.ndarray, "n_a n_omega"], b: Complex[np.ndarray, "n_b n_omega"]
) -> Float[np.ndarray, "n_a n_b"]:
    """Compute Re sum over frequencies of a conj(b), for every pair of rows."""
    return a.view(float) @ b.view(float).T


def _multiply_own(
    E: Complex[np.ndarray, "n_own n_omega"], own: np.ndarray, weights: SpectralMatrix
) -> Float[np.ndarray, "n_own n_own"]:
    """Compute Re sum conj(E_a) W_ab E_b of the parameters of single outputs, output by output."""
    total = np.zeros((own.size, own.size))
    blocks = weights.expand_blocks()
    for output in np.unique(own).tolist():
        mine = np.flatnonzero(own == output)
        if weights.is_diagonal:
            total[np.ix_(mine, mine)] = _multiply_real(blocks[:, output] * E[mine], E[mine])
            continue
        later = np.flatnonzero(own >= output)  # the rest follows from symmetry
        loads = np.multiply(blocks[:, output].T[own[later]], E[later], order="C")
        part = _multiply_real(E[mine], loads)
        total[np.ix_(mine, later)] = part
        total[np.ix_(later, mine)] = part.T
    return total


@lru_cache(maxsize=32)  # a campaign fits one model structure to many maneuvers
def _index_pairs(
    pair_rows: tuple[int, ...], pair_columns: tuple[int, ...], n_r: int, n_w: int
) -> np.ndarray:
    """Return the index of the sum of A_ii' conj(w_j) w_j' of every pair of parameters.

    Only i <= i' and j <= j' are computed, with A and with its conjugate below it; the rest
    follows from symmetry, as both are Hermitian.
    """
    rows, columns = np.array(pair_rows, dtype=int), np.array(pair_columns, dtype=int)
    blocks, products = _number_pairs(n_r), _number_pairs(n_w)
    turned = (rows[:, None] - rows) * (columns[:, None] - columns) < 0
    block = blocks[np.ix_(rows, rows)] + np.where(turned, n_r * (n_r + 1) // 2, 0)
    return block * (n_w * (n_w + 1) // 2) + products[np.ix_(columns, columns)]


def _number_pairs(n: int) -> np.ndarray:
    """Number the pairs of an upper triangle, in either order."""
    number = np.zeros((n, n), dtype=int)
    number[np.triu_indices(n)] = np.arange(n * (n + 1) // 2)
    return np.maximum(number, number.T)


@lru_cache(maxsize=32)
def _index_upper(n: int) -> np.ndarray:
    """Return the indices of the upper triangle in a flattened matrix."""
    return np.flatnonzero(np.triu(np.ones((n, n), dtype=bool)))
