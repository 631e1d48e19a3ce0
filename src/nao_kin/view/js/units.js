// How numbers are written: angles in degrees or radians, as the reader chooses.

const MINUS = "\u2212";
const units = {
  degrees: true,
  listeners: [],
  set(degrees) {
    this.degrees = degrees;
    for (const listener of this.listeners) listener();
  },
  unit(slides) {
    return slides ? "m" : this.degrees ? "°" : "rad";
  },
  factor(slides) {
    return !slides && this.degrees ? 180 / Math.PI : 1;
  },
  digits(slides) {
    return !slides && this.degrees ? 2 : 4;
  },
  // Text of a joint value [rad or m].
  joint(value, slides) {
    return fixed(value * this.factor(slides), this.digits(slides));
  },
  limit(value, slides) {
    return value === null ? "" : shortened(value * this.factor(slides), !slides && this.degrees ? 1 : 3);
  },
  angle(value) {
    return fixed(value * this.factor(false), this.degrees ? 3 : 5);
  },
};

function fixed(value, digits) {
  const text = value.toFixed(digits);
  return (Number(text) === 0 ? text.replace("-", "") : text).replace("-", MINUS);
}

// A positive number in three digits.
function few(value) {
  return value !== 0 && (value < 1e-3 || value >= 1e5) ? value.toExponential(1) : String(Number(value.toPrecision(3)));
}

function shortened(value, digits) {
  return String(Number(value.toFixed(digits)) || 0).replace("-", MINUS);
}

// The number in a text; NaN where it is none.
function numberIn(text) {
  const plain = text.trim().replace(MINUS, "-").replace(",", ".");
  return plain === "" ? NaN : Number(plain);
}
