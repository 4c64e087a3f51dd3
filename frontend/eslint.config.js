import js from "@eslint/js";
import reactHooks from "eslint-plugin-react-hooks";
import tseslint from "typescript-eslint";

/** One direction of imports: pages -> components -> api, lib; api and lib know nothing of each other. */
const floor = (files, forbidden) => ({
  files,
  ignores: ["**/*.test.*"],
  rules: {
    "no-restricted-imports": [
      "error",
      {
        patterns: forbidden.map((folder) => ({
          group: [`**/${folder}/**`, `**/${folder}`],
          message: `Imports run pages -> components -> api, lib; this floor is not above ${folder}.`,
        })),
      },
    ],
  },
});

export default tseslint.config(
  { ignores: ["node_modules", "src/api/schema.gen.ts"] },
  js.configs.recommended,
  {
    files: ["**/*.{ts,tsx}"],
    extends: [...tseslint.configs.strictTypeChecked],
    languageOptions: { parserOptions: { projectService: true } },
    rules: {
      "@typescript-eslint/restrict-template-expressions": ["error", { allowNumber: true }],
      // A failed query is shown by the page; a handler has nothing to await.
      "@typescript-eslint/no-misused-promises": [
        "error",
        { checksVoidReturn: { attributes: false } },
      ],
      "@typescript-eslint/only-throw-error": "off", // the router throws redirects
    },
  },
  {
    files: ["src/**/*.{ts,tsx}"],
    plugins: { "react-hooks": reactHooks },
    rules: reactHooks.configs.recommended.rules,
  },
  {
    files: ["scripts/**"],
    languageOptions: { globals: { process: "readonly", console: "readonly" } },
  },
  {
    files: ["public/**"],
    languageOptions: {
      globals: { document: "readonly", localStorage: "readonly", matchMedia: "readonly" },
    },
  },
  floor(["src/components/**"], ["pages"]),
  floor(["src/api/**"], ["pages", "components", "lib"]),
  floor(["src/lib/**"], ["pages", "components", "api"]),
);
