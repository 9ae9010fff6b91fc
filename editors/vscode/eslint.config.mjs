import tseslint from "typescript-eslint";

export default tseslint.config(tseslint.configs.strictTypeChecked, {
  languageOptions: { parserOptions: { project: ["tsconfig.json", "src/page/tsconfig.json"], tsconfigRootDir: import.meta.dirname } },
  rules: {
    "@typescript-eslint/restrict-template-expressions": ["error", { allowNumber: true }],
    // It does not see that a field changes while one waits.
    "@typescript-eslint/no-unnecessary-condition": "off",
  },
});
