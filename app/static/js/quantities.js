// What a signal measures.

import { select } from "./forms.js";

const NAMES = ["position", "velocity", "acceleration", "force", "angle", "angularVelocity", "angularAcceleration", "torque", "charge", "current", "voltage", "volume", "flow", "pressure", "heat", "heatFlow", "temperature"];

// In words: angular velocity; what to say where it was not stated.
export const quantityText = (name) => (name ? name.replace(/[A-Z]/g, (letter) => ` ${letter.toLowerCase()}`) : "not stated");

export const quantitySelect = () => select([["", "not stated"], ...NAMES.map((name) => [name, quantityText(name)])], "");
