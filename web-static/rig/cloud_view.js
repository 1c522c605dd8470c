export function showClouds() {}
