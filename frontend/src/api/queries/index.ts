/** What pages read: one query per resource. Pages and tests share these keys. */
export * from "./aircraft";
export * from "./designs";
export * from "./flights";
export * from "./flutter";
export * from "./jobs";
export * from "./maneuvers";
export * from "./modes";
export * from "./quality";
export * from "./review";
export * from "./runs";
export * from "./searches";
export * from "./session";
export * from "./structures";
export * from "./uploads";
export * from "./validation";
export * from "./vibration";
export * from "./workbench";
