// Matrices of float32, row by row; sums are in float64, as JavaScript has them.

const matrix = (rows, columns) => ({ rows, columns, values: new Float32Array(rows * columns) });

/** One row of a matrix, which shares its numbers. */
const rowOf = ({ columns, values }, i) => values.subarray(i * columns, (i + 1) * columns);

/** A matrix of rows of numbers, of which there is one at least. */
function matrixOf(rows) {
  const result = matrix(rows.length, rows[0].length);
  rows.forEach((row, i) => rowOf(result, i).set(row));
  return result;
}

/** A matrix whose numbers are a function of another one's. */
function mapped(inputs, transform) {
  return { ...inputs, values: inputs.values.map(transform) };
}

function sumOf(a, b) {
  return { ...a, values: a.values.map((value, i) => value + b.values[i]) };
}

/** Add a row to another one. */
function addTo(row, other) {
  for (let k = 0; k < row.length; k += 1) row[k] += other[k];
}

/** The dot product of two rows. */
const product = (a, b) => a.reduce((sum, value, k) => sum + value * b[k], 0);

/** A linear layer, four rows at a time, so that each weight is read once for four products. */
function linear({ weight, bias }, inputs) {
  const result = matrix(inputs.rows, weight.shape[0]);
  for (let i = 0; i < inputs.rows; i += 4) {
    const rows = [0, 1, 2, 3].map((k) => Math.min(i + k, inputs.rows - 1));
    linearOfFour(weight.values, bias.values, inputs, result, rows);
  }
  return result;
}

function linearOfFour(weights, biases, { columns, values }, result, [i, j, k, l]) {
  const [a, b, c, d] = [i * columns, j * columns, k * columns, l * columns];
  const outputs = result.columns;
  for (let o = 0; o < outputs; o += 1) {
    const from = o * columns;
    const bias = biases[o];
    let ofA = bias;
    let ofB = bias;
    let ofC = bias;
    let ofD = bias;
    for (let n = 0; n < columns; n += 1) {
      const weight = weights[from + n];
      ofA += weight * values[a + n];
      ofB += weight * values[b + n];
      ofC += weight * values[c + n];
      ofD += weight * values[d + n];
    }
    result.values[i * outputs + o] = ofA;
    result.values[j * outputs + o] = ofB;
    result.values[k * outputs + o] = ofC;
    result.values[l * outputs + o] = ofD;
  }
}

const NORM_EPSILON = 1e-5; // torch's

/** Layer normalisation: rows of mean 0 and variance 1, scaled and shifted. */
function layerNorm({ weight, bias }, inputs) {
  const { rows, columns } = inputs;
  const result = matrix(rows, columns);
  for (let i = 0; i < rows; i += 1) {
    const row = rowOf(inputs, i);
    const mean = row.reduce((sum, value) => sum + value, 0) / columns;
    const variance = row.reduce((sum, value) => sum + (value - mean) ** 2, 0) / columns;
    const scale = 1 / Math.sqrt(variance + NORM_EPSILON);
    row.forEach((value, k) => {
      result.values[i * columns + k] = (value - mean) * scale * weight.values[k] + bias.values[k];
    });
  }
  return result;
}

const relu = (value) => Math.max(value, 0);
const gelu = (value) => (value / 2) * (1 + errorFunction(value / Math.SQRT2));
const sigmoid = (value) => 1 / (1 + Math.exp(-value));
const logSigmoid = (value) => Math.min(value, 0) - Math.log1p(Math.exp(-Math.abs(value)));

/** erf to 1.5e-7 (Abramowitz and Stegun, 7.1.26). */
function errorFunction(value) {
  const t = 1 / (1 + 0.3275911 * Math.abs(value));
  const series = t * (0.254829592 + t * (-0.284496736 + t * (1.421413741
    + t * (-1.453152027 + t * 1.061405429))));
  return Math.sign(value) * (1 - series * Math.exp(-value * value));
}

/** Numbers as probabilities. */
function softmax(scores) {
  const most = Math.max(...scores);
  const weights = scores.map((score) => Math.exp(score - most));
  const total = weights.reduce((sum, weight) => sum + weight, 0);
  return weights.map((weight) => weight / total);
}

function logSoftmax(scores) {
  const most = Math.max(...scores);
  const total = scores.reduce((sum, score) => sum + Math.exp(score - most), 0);
  return scores.map((score) => score - most - Math.log(total));
}
