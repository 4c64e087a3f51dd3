/** What pages change: submit, cancel, import, delete. */
export * from "./aircraft";
export * from "./designs";
export * from "./jobs";
export * from "./lists";
export * from "./live";
export * from "./maneuvers";
export * from "./modes";
export * from "./notes";
export * from "./review";
export * from "./runs";
export * from "./searches";
export * from "./session";
export * from "./structures";
export * from "./uploads";
