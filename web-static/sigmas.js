// How far something is off, counted in its own sigmas: server/report/text/sigmas.h for scripts, with the same limits, classes (and so
// colours) and texts.
export const OFF_SIGMAS = 3;  // from here on it is "off"
const MOST_BELOW_SIGMAS = 2.9;

// "fit0" below 1, "fit1" below 2, "fit2" below OFF_SIGMAS, "fit3" from there on and for what is no number.
export function sigmasClass(inSigmas) {
  if (inSigmas < 1) return "fit0";
  if (inSigmas < 2) return "fit1";
  return inSigmas < OFF_SIGMAS ? "fit2" : "fit3";
}

// One decimal; never rounded up to the limit.
export function sigmasText(inSigmas) {
  return (inSigmas < OFF_SIGMAS ? Math.min(inSigmas, MOST_BELOW_SIGMAS) : inSigmas).toFixed(1);
}
