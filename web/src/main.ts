// Where the page begins.
import { mount } from 'svelte';
import '@fontsource/roboto/latin-400.css';
import '@fontsource/roboto/latin-500.css';
import '@fontsource/roboto/latin-700.css';
import './theme/colors.css';
import './theme/base.css';
import App from './App.svelte';

const target = document.getElementById('page');
if (target) mount(App, { target });
